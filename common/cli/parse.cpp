// SPDX-License-Identifier: MIT
#include "common/cli/parse.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <vector>

#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/program_flags.hpp"
#include "common/cli/run_program.hpp"
#include "common/mdns.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

/// Returns the option `name` of the subcommand `app`, or of the program; null if there is none.
const CLI::Option* findOption(const CLI::App& app, const std::string& name) {
  const CLI::Option* const own = app.get_option_no_throw(name);
  if (own != nullptr || app.get_parent() == nullptr) return own;
  return app.get_parent()->get_option_no_throw(name);
}

/// Returns the parser of the program.
const CLI::App& findProgram(const CLI::App& app) {
  return app.get_parent() != nullptr ? *app.get_parent() : app;
}

/// Returns a hint for a flag that `app` does not have. It is empty if there is none.
std::string flagHint(const CLI::App& app, const std::string& word) {
  if (word == "-v" || word == "-V") return "; did you mean --version?";
  const std::string flag = word.substr(0, word.find('='));
  const CLI::App& program = findProgram(app);
  if (const auto owner = findOwner(program, flag, app); !owner.empty())
    return "; " + flag + " is a flag of " + program.get_name() + " " + owner;
  if (const auto owner = ownerOfFlag(flag, program.get_name()); !owner.empty())
    return "; " + flag + " is a flag of " + std::string(owner);
  std::vector<std::string> flags;
  for (const CLI::App* const each : {&app, &program}) {
    for (const CLI::Option* const option : each->get_options()) {
      for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    }
  }
  return spellingHint(flag, flags);
}

/// Returns the unknown arguments of `app` as one text, with a hint for the first flag.
std::string listUnknownWords(const CLI::App& app) {
  std::string words;
  std::string meant;
  bool a_flag = false;
  const std::vector<std::string> unknown = findProgram(app).remaining(true);
  for (const std::string& word : unknown) {
    words += " " + quote(word);
    if (!word.starts_with('-')) continue;
    a_flag = true;
    if (meant.empty()) meant = flagHint(app, word);
  }
  return words + (a_flag ? meant : "; is a flag missing in front of it?");
}

template <class Kind>
bool is(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

/// Returns the message for a flag with too many values or none.
std::string countComplaint(const CLI::App& app, const std::string& what) {
  const std::string flag = what.substr(0, what.find(':'));
  const CLI::Option* const option = findOption(app, flag);
  const bool many = option != nullptr && option->count() > 1;
  return flag + (many ? ": this flag may appear only once" : ": its value is missing");
}

/// Returns the message for CLI11's error, with the flag and the cause.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  if (is<CLI::ConversionError>(error)) {
    // CLI11 prepends its own words to the flag and its value.
    const std::size_t words = what.find(": ");
    return (words == std::string::npos ? what : what.substr(words + 2)) +
           ": a flag is on or off (true or false)";
  }
  const bool understood = findProgram(app).remaining(true).empty();
  if (is<CLI::ArgumentMismatch>(error) && understood) return countComplaint(app, what);
  // A misspelt flag makes a required one missing: state the cause.
  if (!understood) return "not understood:" + listUnknownWords(app);
  return what;
}

/// Returns whether the error's cause is in none of the arguments: neither a name of its flag nor
/// its value.
bool isFromConfig(const CLI::App& app, const std::string& line, int argc, const char* const* argv) {
  const std::string key = line.substr(0, line.find_first_of(": "));
  const CLI::Option* const option = key.starts_with("-") ? findOption(app, key) : nullptr;
  return std::none_of(argv + 1, argv + argc, [&](const std::string& argument) {
    if (option == nullptr) return line.find(quote(argument)) != std::string::npos;
    const auto& values = option->results();
    return option->check_name(argument.substr(0, argument.find('='))) ||
           std::find(values.begin(), values.end(), argument) != values.end();
  });
}

/// Returns the message with the config file's name, if the error is there.
std::string complaint(const CLI::App& app, const CLI::ParseError& error, int argc,
                      const char* const* argv) {
  const CLI::Option& config_file = *findProgram(app).get_config_ptr();
  const auto files = config_file.results();  // several files are an error themselves
  std::string file = files.empty() ? config_file.get_default_str() : files.back();
  // A default file becomes a result only after its lines were read.
  if (files.empty() && ::access(file.c_str(), R_OK) != 0) file.clear();
  const std::string config = "--config " + file;
  if (is<ConfigFileError>(error)) return config + error.what();
  if (is<CLI::FileError>(error)) return config + ": cannot be read";
  const std::string line = complaint(app, error);
  const bool required = is<CLI::RequiredError>(error);
  return !file.empty() && !required && isFromConfig(app, line, argc, argv) ? config + ": " + line
                                                                           : line;
}

/// Returns the option of `app` that `word` names, or null.
const CLI::Option* findFlag(const CLI::App& app, const std::string& word) {
  return word.starts_with("--") ? findOption(app, word.substr(0, word.find('='))) : nullptr;
}

/// Returns whether `word` is a flag of `app` or of another subcommand.
bool isAnyFlag(const CLI::App& app, const std::string& word) {
  if (findFlag(app, word) != nullptr) return true;
  return word.starts_with("--") &&
         !findOwner(findProgram(app), word.substr(0, word.find('=')), app).empty();
}

/// Throws CLI::ValidationError for an option whose value is missing before another flag. CLI11
/// reads that flag as the value.
void requireValues(const CLI::App& app, int argc, const char* const* argv) {
  for (int i = 1; i + 1 < argc; ++i) {
    const std::string word = argv[i];
    const CLI::Option* const option = findFlag(app, word);
    const bool wants_value = option != nullptr && option->get_items_expected_min() > 0;
    if (!wants_value || word.find('=') != std::string::npos) continue;
    if (!isAnyFlag(app, argv[i + 1])) {
      ++i;
      continue;
    }
    const std::string form = option->get_type_name();
    throw CLI::ValidationError(word, "its value " + form + " is missing before " + argv[i + 1]);
  }
}

}  // namespace

std::optional<std::string> parseArguments(CLI::App& app, int argc, const char* const* argv,
                                          const SubcommandChoice& choice) {
  const std::vector<std::string> words =
      chooseSubcommand(app, choice, std::vector<std::string>(argv + 1, argv + argc));
  std::vector<const char*> arguments(1, argv[0]);
  for (const std::string& word : words) arguments.push_back(word.c_str());
  const int count = static_cast<int>(arguments.size());
  const CLI::App& subcommand =
      findSubcommand(app, words.empty() ? std::string_view() : words.front());
  try {
    requireValues(subcommand, count, arguments.data());
    app.parse(count, arguments.data());
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ParseError& error) {
    return sanitizeUtf8(complaint(subcommand, error, count, arguments.data()));
  }
  return std::nullopt;
}

/// Prints the help of `app` or of its subcommand; with the mode All of all subcommands. The
/// descriptions state the defaults.
void printHelp(CLI::App& app, CLI::AppFormatMode mode) {
  for (CLI::App* const each : app.get_subcommands({})) {
    for (CLI::Option* const option : each->get_options()) option->default_str("");
  }
  for (CLI::Option* const option : app.get_options()) option->default_str("");
  std::cout << app.help("", mode);
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const SubcommandChoice& choice) {
  startLog(app.get_name());
  try {
    const auto problem = parseArguments(app, argc, argv, choice);
    if (!problem) return std::nullopt;
    spdlog::error("{} (--help lists the flags and their values)", *problem);
    return kWrongInput;
  } catch (const CLI::CallForHelp&) {
    printHelp(app, CLI::AppFormatMode::Normal);
    return 0;
  } catch (const CLI::CallForAllHelp&) {
    printHelp(app, CLI::AppFormatMode::All);
    return 0;
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << "\n";
    return 0;
  }
}

void requireDiscovery(const std::string& flag) {
  if (!kHasDiscovery)
    throw CLI::ValidationError(flag,
                               "this build has no Avahi, so it cannot announce or find servers");
}

std::string serviceName(const std::string& flag, const std::string& text) {
  requireDiscovery(flag);
  if (!isServiceName(text)) {
    throw CLI::ValidationError(flag, quote(text) +
                                         " is not a name of 1 to 63 bytes of UTF-8 without control "
                                         "characters");
  }
  return text;
}

}  // namespace hapticast
