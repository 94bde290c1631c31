// SPDX-License-Identifier: MIT
#include "common/cli/parse.hpp"

#include <iostream>
#include <vector>

#include "common/cli/config_file.hpp"
#include "common/cli/suggest.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

/// What `app` did not know, as one text, and what its first flag may have meant.
std::string unknownWords(const CLI::App& app) {
  std::string words;
  std::string meant;
  std::vector<std::string> flags;
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  for (const std::string& word : app.remaining()) {
    words += " " + inQuotes(word);
    if (meant.empty() && word.starts_with('-'))
      meant = didYouMean(word.substr(0, word.find('=')), flags);
  }
  return words + meant;
}

template <class Kind>
bool is(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

/// CLI11's complaint in words that name the flag or file and what is wrong with it.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  const std::string config = "--config " + app.get_config_ptr()->as<std::string>();
  if (is<ConfigFileError>(error)) return config + what;
  if (is<CLI::FileError>(error)) return config + ": cannot be read";
  if (is<CLI::ConversionError>(error)) {
    // CLI11 puts its own words in front of the flag and its value.
    const std::size_t words = what.find(": ");
    return (words == std::string::npos ? what : what.substr(words + 2)) +
           ": a flag is on or off (true or false)";
  }
  if (is<CLI::ArgumentMismatch>(error) && app.remaining().empty()) {
    const std::string flag = what.substr(0, what.find(':'));
    const CLI::Option* const option = app.get_option_no_throw(flag);
    if (option != nullptr && option->count() > 1) return flag + ": may be given only once";
  }
  // A mistyped flag makes a required one missing: name the cause.
  if (!app.remaining().empty()) return "not understood:" + unknownWords(app);
  return what;
}

}  // namespace

std::string oneLine(std::string text) {
  for (char& c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F) c = '?';
  }
  return text;
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return 0;
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << "\n";
    return 0;
  } catch (const CLI::ParseError& error) {
    std::cerr << app.get_name() << ": " << oneLine(complaint(app, error))
              << " (--help lists what is allowed)\n";
    return 2;
  }
  return std::nullopt;
}

}  // namespace hapticast
