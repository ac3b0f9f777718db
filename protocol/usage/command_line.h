// What the command lines of all programs share: durations, options that the environment sets, and what is said of
// mistakes. It stands below server and client because both have programs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace wobble::usage {

// The environment's variable of an option: WOBBLE_MAX_CLIENTS of "--max-clients".
[[nodiscard]] std::string FindVariable(const std::string& option);

// A duration, as ParseDuration reads it, into `seconds`, whose present value the help shows. Throws as CLI11's checks
// do while it parses; with `refuse` calls that instead, with the text that is no duration.
CLI::Option* AddDuration(CLI::App& command, const std::string& name, double& seconds, const std::string& description,
                         const std::function<void(const std::string& text)>& refuse = {});

// Lets every option of the command with a long name, but --help and --version, be set by its variable: returns the
// arguments with what the environment adds, and names the variables in the help. What the arguments themselves have
// wins, also over the variable of an option that they exclude; an empty variable sets nothing. An option that may be
// repeated takes the words of its variable, which blanks separate. Call it once all options are described, and parse
// the result.
[[nodiscard]] std::vector<std::string> AddEnvironment(CLI::App& command, std::vector<std::string> arguments);

// Lets no option of the command take an empty word, which, as of a script's unset variable, would mean that the option
// is not given. Positional words, such as those of orders, may be empty.
void RefuseEmptyWords(CLI::App& command);

// As app.parse(argc, argv), of arguments without the program's name.
void Parse(CLI::App& app, std::vector<std::string> arguments);

// The mistake with the names of variables in place of the options whose values came from them.
[[nodiscard]] std::string NameVariables(const CLI::App& command, std::string mistake);

// One line that says what is wrong; of an unknown option or command also which known one it is like. arguments: those
// that were parsed.
[[nodiscard]] std::string Explain(const CLI::App& command, const CLI::ParseError& mistake,
                                  const std::vector<std::string>& arguments);

}  // namespace wobble::usage
