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
#include "common/endpoint.hpp"
#include "common/mdns.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

bool isAddress(const std::string& word) {
  const auto endpoint = parseEndpoint(word, Endpoint{});
  if (!endpoint) return false;
  return endpoint->host == "localhost" ||
         endpoint->host.find_first_not_of("0123456789.") == std::string::npos;
}

/// Returns a hint for an argument of `app` that is no flag.
std::string argumentHint(const CLI::App& app, const std::string& word) {
  if (word == "help") return "; did you mean --help?";
  if (app.get_option_no_throw("--listen") != nullptr && isAddress(word))
    return "; is --listen missing in front of it? Only hapticast-client takes a bare address";
  return "; is a flag missing in front of it?";
}

/// Returns a hint for a flag that `app` does not have. It is empty if there is none.
std::string flagHint(const CLI::App& app, const std::string& word) {
  if (word == "-v" || word == "-V") return "; did you mean --version?";
  const std::string flag = word.substr(0, word.find('='));
  if (const auto owner = ownerOfFlag(flag, app.get_name()); !owner.empty())
    return "; " + flag + " is a flag of " + std::string(owner);
  std::vector<std::string> flags;
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return spellingHint(flag, flags);
}

/// Returns the unknown arguments of `app` as one text, with a hint for the first flag.
std::string listUnknownWords(const CLI::App& app) {
  std::string words;
  std::string meant;
  bool a_flag = false;
  const std::vector<std::string> unknown = app.remaining();
  for (const std::string& word : unknown) {
    words += " " + quote(word);
    if (!word.starts_with('-')) continue;
    a_flag = true;
    if (meant.empty()) meant = flagHint(app, word);
  }
  return words + (a_flag ? meant : argumentHint(app, unknown.front()));
}

template <class Kind>
bool is(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

/// Returns the message for a flag with too many values or none.
std::string countComplaint(const CLI::App& app, const std::string& what) {
  const std::string flag = what.substr(0, what.find(':'));
  const CLI::Option* const option = app.get_option_no_throw(flag);
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
  if (is<CLI::ArgumentMismatch>(error) && app.remaining().empty()) return countComplaint(app, what);
  // A misspelt flag makes a required one missing: state the cause.
  if (!app.remaining().empty()) return "not understood:" + listUnknownWords(app);
  return what;
}

/// Returns whether the error's cause is in none of the arguments: neither its flag nor, for a key
/// without one, its value.
bool isFromConfig(const std::string& line, int argc, const char* const* argv) {
  const std::string key = line.substr(0, line.find_first_of(": "));
  return std::none_of(argv + 1, argv + argc, [&](const std::string& argument) {
    if (!key.starts_with("--")) return line.find(quote(argument)) != std::string::npos;
    return argument == key || argument.starts_with(key + "=");
  });
}

/// Returns the message with the config file's name, if the error is there.
std::string complaint(const CLI::App& app, const CLI::ParseError& error, int argc,
                      const char* const* argv) {
  const auto files = app.get_config_ptr()->results();  // several files are an error themselves
  std::string file = files.empty() ? app.get_config_ptr()->get_default_str() : files.back();
  // A default file becomes a result only after its lines were read.
  if (files.empty() && ::access(file.c_str(), R_OK) != 0) file.clear();
  const std::string config = "--config " + file;
  if (is<ConfigFileError>(error)) return config + error.what();
  if (is<CLI::FileError>(error)) return config + ": cannot be read";
  const std::string line = complaint(app, error);
  const bool required = is<CLI::RequiredError>(error);
  return !file.empty() && !required && isFromConfig(line, argc, argv) ? config + ": " + line : line;
}

/// Returns the option of `app` that `word` names, or null.
const CLI::Option* findFlag(const CLI::App& app, const std::string& word) {
  return word.starts_with("--") ? app.get_option_no_throw(word.substr(0, word.find('='))) : nullptr;
}

/// Throws CLI::ValidationError for an option whose value is missing before another flag. CLI11
/// reads that flag as the value.
void requireValues(const CLI::App& app, int argc, const char* const* argv) {
  for (int i = 1; i + 1 < argc; ++i) {
    const std::string word = argv[i];
    const CLI::Option* const option = findFlag(app, word);
    const bool wants_value = option != nullptr && option->get_items_expected_min() > 0;
    if (!wants_value || word.find('=') != std::string::npos) continue;
    if (findFlag(app, argv[i + 1]) == nullptr) {
      ++i;
      continue;
    }
    const std::string form = option->get_type_name();
    throw CLI::ValidationError(word, "its value " + form + " is missing before " + argv[i + 1]);
  }
}

}  // namespace

std::optional<std::string> parseArguments(CLI::App& app, int argc, const char* const* argv) {
  try {
    requireValues(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ParseError& error) {
    return sanitizeUtf8(complaint(app, error, argc, argv));
  }
  return std::nullopt;
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  startLog(app.get_name());
  try {
    const auto problem = parseArguments(app, argc, argv);
    if (!problem) return std::nullopt;
    spdlog::error("{} (--help lists the flags and their values)", *problem);
    return kWrongInput;
  } catch (const CLI::CallForHelp&) {
    // The descriptions state the defaults.
    for (CLI::Option* const option : app.get_options()) option->default_str("");
    std::cout << app.help();
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
