// SPDX-License-Identifier: MIT
#include "common/command_line.hpp"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <sstream>
#include <string_view>
#include <system_error>

#include "common/text.hpp"

namespace hapticast {

namespace {

Vec2 pairOrThrow(const std::string& name, const std::string& text, const std::string& form) {
  const auto pair = parsePair(text);
  if (!pair) throw CLI::ValidationError(name, inQuotes(text) + " is not " + form);
  return *pair;
}

/// Config files as readKeyValues() has them. CLI11's own reader takes sections, nests them without
/// a limit, and loses a key that is repeated further down.
class KeyValueConfig : public CLI::ConfigBase {
 public:
  [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    const auto pairs = readKeyValues(in, "--config");
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
    const char* const end = rest.data() + rest.size();
    const auto [stop, error] = std::from_chars(rest.data() + 1, end, endpoint.port);
    if (error != std::errc() || stop != end) return std::nullopt;
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

CLI::Validator numberFrom(double least, double most) {
  std::ostringstream range;
  range << least << " to " << most;
  return {[least, most, range = range.str()](std::string& text) {
            const auto value = parseNumber(text);
            if (value && *value >= least && *value <= most) return std::string();
            return inQuotes(text) + " is not a number from " + range;
          },
          range.str()};
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

CLI::Option* addPair(CLI::App& app, const std::string& name, std::optional<Vec2>& value,
                     const std::string& help, const std::string& form) {
  const auto set = [&value, name, form](const std::string& text) {
    value = pairOrThrow(name, text, form);
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(form.substr(0, form.find(' ')));
}

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
  app.set_config("--config", "", "File of KEY = VALUE lines; every flag is a key of the same name");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<KeyValueConfig>());
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
    std::string line = error.what();
    for (char& c : line) c = c == '\n' ? ' ' : c;
    std::cerr << app.get_name() << ": " << line << " (--help lists what is allowed)\n";
    return 2;
  }
  return std::nullopt;
}

}  // namespace hapticast
