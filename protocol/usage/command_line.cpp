// CLI11 reads variables by itself (Option::envname), but it has the option's name in every mistake where a person looks
// for the variable's, takes no lists, reads the variables of all subcommands, and lets a variable meet an option that
// excludes it. So variables become arguments here, before CLI11 parses; envname is then set only of options whose value
// came from there, which NameVariables reads again.
#include "protocol/usage/command_line.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "protocol/usage/capitals.h"
#include "protocol/usage/duration.h"
#include "protocol/usage/likeness.h"

namespace wobble::usage {
namespace {

// "--port" of "--port=7"; any other argument as it is.
std::string FindOption(const std::string& argument) { return argument.substr(0, argument.find('=')); }

bool IsGiven(const CLI::Option& option, const std::vector<std::string>& arguments) {
  return std::ranges::any_of(arguments, [&](const std::string& argument) {
    return argument.starts_with("-") && option.check_name(FindOption(argument));
  });
}

// Of help, version, and words that stand without a name, there is no variable.
bool HasVariable(const CLI::App& command, const CLI::Option& option) {
  return !option.get_lnames().empty() && &option != command.get_help_ptr() && !option.check_lname("version");
}

std::string LongName(const CLI::Option& option) { return "--" + option.get_lnames().front(); }

std::vector<std::string> SplitWords(const CLI::Option& option, const std::string& text) {
  if (option.get_items_expected_max() <= 1 || option.get_delimiter() != '\0') return {text};
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::string FindVariable(const std::string& option) {
  return "WOBBLE_" +
         InCapitals(std::string_view(option).substr(std::min(option.find_first_not_of('-'), option.size())));
}

CLI::Option* AddDuration(CLI::App& command, const std::string& name, double& seconds, const std::string& description,
                         const std::function<void(const std::string& text)>& refuse) {
  const auto read = [name, &seconds, refuse](const std::string& text) {
    std::string error;
    const auto duration = ParseDuration(text, error);
    if (duration) {
      seconds = *duration;
    } else if (refuse) {
      refuse(text);
    } else {
      throw CLI::ValidationError(name, error);
    }
  };
  char present[32];
  std::snprintf(present, sizeof present, "%g", seconds);
  return command.add_option_function<std::string>(name, read, description)->type_name("DURATION")->default_str(present);
}

std::vector<std::string> AddEnvironment(CLI::App& command, std::vector<std::string> arguments) {
  const std::vector<std::string> given = arguments;
  const bool asksOnly = std::ranges::any_of(
      given, [](const std::string& word) { return word == "--help" || word == "-h" || word == "--version"; });
  for (CLI::Option* option : command.get_options([&](CLI::Option* each) { return HasVariable(command, *each); })) {
    const std::string variable = FindVariable(LongName(*option));
    option->description(option->get_description() + " [" + variable + "]");
    const char* text = std::getenv(variable.c_str());
    const auto excluded = option->get_excludes();
    const bool isOut = IsGiven(*option, given) ||
                       std::ranges::any_of(excluded, [&](const CLI::Option* other) { return IsGiven(*other, given); });
    if (asksOnly || isOut || text == nullptr || *text == '\0') continue;
    option->envname(variable);
    for (const std::string& word : SplitWords(*option, text)) arguments.push_back(LongName(*option) + "=" + word);
  }
  return arguments;
}

void RefuseEmptyWords(CLI::App& command) {
  command.parse_complete_callback([&command] {
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_positional()) continue;
      for (const std::string& word : option->results()) {
        if (word.empty()) throw CLI::ValidationError(option->get_name(), "must not be empty");
      }
    }
  });
}

void Parse(CLI::App& app, std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // as CLI11 wants them
  app.parse(std::move(arguments));
}

std::string NameVariables(const CLI::App& command, std::string mistake) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_envname().empty()) continue;
    const std::string name = LongName(*option);
    for (std::size_t at = 0; (at = mistake.find(name, at)) != std::string::npos; at += name.size()) {
      const char next = at + name.size() < mistake.size() ? mistake[at + name.size()] : ' ';
      const bool isWhole = std::isalnum(static_cast<unsigned char>(next)) == 0 && next != '-';
      if (isWhole) mistake.replace(at, name.size(), option->get_envname());
    }
  }
  return mistake;
}

std::string Explain(const CLI::App& command, const CLI::ParseError& mistake,
                    const std::vector<std::string>& arguments) {
  if (dynamic_cast<const CLI::ExtrasError*>(&mistake) == nullptr) return NameVariables(command, mistake.what());
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty()) known.push_back(LongName(*option));
  }
  const auto isUnknown = [&](const std::string& word) {
    return word.starts_with("--") && word.size() > 2 && command.get_option_no_throw(FindOption(word)) == nullptr;
  };
  const auto unknown = std::ranges::find_if(arguments, isUnknown);
  if (unknown != arguments.end())
    return "there is no option " + FindOption(*unknown) + Suggest(FindOption(*unknown), known);
  std::vector<std::string> commands;
  for (const CLI::App* each : command.get_subcommands({})) commands.push_back(each->get_name());
  if (commands.empty() || arguments.empty()) return mistake.what();
  return "there is no command " + arguments.front() + Suggest(arguments.front(), commands);
}

}  // namespace wobble::usage
