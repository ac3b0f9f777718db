// The recording is played by wobbled, which takes the place of this process: a client knows no physics.
#include "client/export/command.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace wobble::exporting {
namespace {

struct Words {
  std::string file;
  std::string format = "csv";
  std::string output;  // empty: the recording's name, in the present folder
  bool isForced = false;
  std::vector<std::string> further;
};

std::string FindOutput(const Words& words) {
  if (!words.output.empty()) return words.output;
  const std::string name = std::filesystem::path(words.file).stem().string();
  if (words.format == "csv") return name + ".csv";
  return words.format == "gltf" ? name + ".glb" : name;
}

int Run(const Words& words) {
  if (words.file.empty()) {
    std::fprintf(stderr, "wobble export: FILE of the recording is required (see wobble export --help)\n");
    return command::kExitBadUse;
  }
  const std::string program = (command::FindProgramFolder() / "wobbled").string();
  std::vector<std::string> line{program,           "--replay", words.file,  "--export",
                                FindOutput(words), "--format", words.format};
  if (words.isForced) line.emplace_back("--force");
  line.insert(line.end(), words.further.begin(), words.further.end());
  std::vector<char*> pointers;
  for (std::string& word : line) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  std::fprintf(stderr, "wobble export: %s: %s\n", program.c_str(), std::strerror(errno));
  return command::kExitBadUse;
}

}  // namespace

command::Command DescribeExport(CLI::App& app) {
  const auto words = std::make_shared<Words>();
  CLI::App* subcommand = app.add_subcommand("export", "Writes what a recording holds for other programs");
  subcommand->add_option("file", words->file, "The recording (wobbled --record)")->type_name("FILE REQUIRED");
  subcommand
      ->add_option("--format", words->format,
                   "csv: a table, a row a body and frame, with pose and energies. vtk: a .pvd series of PolyData with "
                   "velocity, force and energy of each vertex, for ParaView. gltf: an animation as one .glb, for "
                   "Blender and the web, turned so that y is up. SI units; csv and vtk z up")
      ->check(CLI::IsMember({"csv", "vtk", "gltf"}))
      ->capture_default_str();
  subcommand
      ->add_option("--output", words->output, "File (csv, gltf) or new folder (vtk); the recording's name if not given")
      ->type_name("PATH");
  subcommand->add_flag("--force", words->isForced, "Replace what is there already, unless it is a recording");
  const auto pass = [&](const char* name, const char* type, const char* what) {
    const auto take = [words, name = std::string(name)](const std::string& value) {
      words->further.insert(words->further.end(), {name, value});
    };
    subcommand->add_option_function<std::string>(name, take, what)->type_name(type);
  };
  pass("--from", "SECONDS", "First second of the recording; 0 if not given");
  pass("--to", "SECONDS", "Last second; the recording's end if not given; as --from: one frame");
  pass("--fps", "NUMBER", "Frames a second, at most the recording's ticks a second; 30 if not given");
  pass("--bodies", "3,7,12", "Numbers of the bodies; all if not given");
  subcommand->footer(
      "Examples:\n"
      "  wobble export matches/arena-20261124-180000.wobrec\n"
      "  wobble export matches/arena-20261124-180000.wobrec --format gltf --from 60 --to 70\n"
      "  wobble export matches/arena-20261124-180000.wobrec --format vtk --from 12 --to 15 --bodies 3,7");
  return {subcommand, [words](const command::IsStopAsked&) { return Run(*words); }};
}

}  // namespace wobble::exporting
