// SPDX-License-Identifier: MIT
#include "common/cli/command_line.hpp"

#include <algorithm>
#include <charconv>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "common/text.hpp"

namespace hapticast {

namespace {

/// The whole of `text` as a number; nullopt otherwise. Doubles are finite.
template <class Number>
std::optional<Number> parsed(std::string_view text) {
  if constexpr (std::is_same_v<Number, double>) {
    return parseNumber(text);
  } else {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
  }
}

Vec2 pairOrThrow(const std::string& name, const std::string& text, const std::string& form) {
  const auto pair = parsePair(text);
  if (!pair) throw CLI::ValidationError(name, inQuotes(text) + " is not " + form);
  return *pair;
}

/// What `app` did not know, as one text.
std::string unknownWords(const CLI::App& app) {
  std::string words;
  for (const std::string& word : app.remaining()) words += " '" + word + "'";
  return words;
}

/// Marks what readKeyValues() says of a config file; the file's name takes its place.
const std::string kConfigText = "config text";

/// CLI11's complaint in words that name the flag or file and what is wrong with it.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  const auto after = [&what](const std::string& start) {
    return what.starts_with(start) ? what.substr(start.size()) : what;
  };
  const std::string config = "--config " + app.get_config_ptr()->as<std::string>();
  if (dynamic_cast<const CLI::FileError*>(&error) != nullptr) {
    return config + (what.starts_with(kConfigText) ? after(kConfigText) : ": cannot be read");
  }
  if (dynamic_cast<const CLI::ConfigError*>(&error) != nullptr) {
    return config + ": '" + after("INI was not able to parse ") + "' is no flag's name";
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {
    return after("Could not convert: ") + ": a flag is on or off (true or false)";
  }
  if (const std::size_t at = what.find(": At Most 1 required"); at != std::string::npos) {
    return what.substr(0, at) + ": may be given only once";
  }
  // A mistyped flag makes a required one missing: name the cause.
  if (!app.remaining().empty()) return "not understood:" + unknownWords(app);
  return what;
}

/// Config files as readKeyValues() has them. CLI11's own reader takes sections, nests them without
/// a limit, and loses a key that is repeated further down.
class KeyValueConfig : public CLI::ConfigBase {
 public:
  [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    const auto pairs = readKeyValues(in, kConfigText);
    if (!pairs.ok()) throw CLI::FileError(pairs.error().message, CLI::ExitCodes::FileError);
    std::vector<CLI::ConfigItem> items;
    for (const KeyValue& pair : pairs.value()) {
      const auto same = std::find_if(items.begin(), items.end(),
                                     [&](const auto& item) { return item.name == pair.key; });
      CLI::ConfigItem& item = same != items.end() ? *same : items.emplace_back();
      item.name = pair.key;
      item.inputs.push_back(pair.value);
    }
    return items;
  }
};

}  // namespace

std::optional<Endpoint> parseEndpoint(const std::string& text) {
  Endpoint endpoint;
  std::string_view rest = text;
  if (rest.starts_with('[')) {
    const std::size_t close = rest.find(']');
    if (close == std::string_view::npos) return std::nullopt;
    endpoint.host = rest.substr(1, close - 1);
    rest.remove_prefix(close + 1);
    if (!rest.empty() && !rest.starts_with(':')) return std::nullopt;
  } else {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    endpoint.host = rest.substr(0, colon);
    rest.remove_prefix(colon);
  }
  if (endpoint.host.empty() || endpoint.host.find_first_of(" \t/") != std::string::npos)
    return std::nullopt;
  if (!rest.empty()) {
    const auto port = parsed<std::uint16_t>(rest.substr(1));
    if (!port) return std::nullopt;
    endpoint.port = *port;
  }
  return endpoint;
}

std::optional<Vec2> parsePair(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string_view view = text;
  const auto first = parseNumber(view.substr(0, comma));
  const auto second = parseNumber(view.substr(comma + 1));
  if (!first || !second) return std::nullopt;
  return Vec2(*first, *second);
}

CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         const std::string& help) {
  const auto set = [&value, name](const std::string& text) {
    const auto endpoint = parseEndpoint(text);
    if (!endpoint) {
      throw CLI::ValidationError(
          name, inQuotes(text) + " is not HOST, HOST:PORT or [V6ADDRESS]:PORT (port 0..65535)");
    }
    value = *endpoint;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name("HOST[:PORT]");
}

template <class Number>
Number numberOrThrow(const std::string& name, const std::string& text, Number least, Number most) {
  if (const auto value = parsed<Number>(text); value && *value >= least && *value <= most) {
    return *value;
  }
  std::ostringstream form;
  form << std::setprecision(12) << (std::is_integral_v<Number> ? "a whole number" : "a number")
       << " from " << least << " to " << most;
  throw CLI::ValidationError(name, inQuotes(text) + " is not " + form.str());
}
template double numberOrThrow(const std::string&, const std::string&, double, double);
template std::uint64_t numberOrThrow(const std::string&, const std::string&, std::uint64_t,
                                     std::uint64_t);

CLI::Option* addPairs(CLI::App& app, const std::string& name, std::vector<Vec2>& values,
                      const std::string& help, const std::string& form) {
  const auto set = [&values, name, form](const std::vector<std::string>& texts) {
    values.clear();
    for (const std::string& text : texts) values.push_back(pairOrThrow(name, text, form));
  };
  return app.add_option_function<std::vector<std::string>>(name, set, help)
      ->type_name(form.substr(0, form.find(' ')))
      ->allow_extra_args(false);
}

void addConfigFile(CLI::App& app) {
  app.set_config("--config", "", "File of KEY = VALUE lines; every flag is a key of the same name")
      ->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<KeyValueConfig>());
}

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
