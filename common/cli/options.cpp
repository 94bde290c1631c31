// SPDX-License-Identifier: MIT
#include "common/cli/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <iomanip>
#include <istream>
#include <memory>
#include <set>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/cli/program_flags.hpp"
#include "common/cli/subcommands.hpp"
#include "common/text.hpp"

namespace hapticast {

std::optional<Vec2> parsePair(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string_view view = text;
  const auto first = parseNumber(view.substr(0, comma));
  const auto second = parseNumber(view.substr(comma + 1));
  if (!first || !second) return std::nullopt;
  return Vec2(*first, *second);
}

Endpoint parseEndpointOr(const std::string& text, const Endpoint& otherwise,
                         const std::string& name, std::uint16_t least_port,
                         const std::string& form) {
  const auto endpoint = parseEndpoint(text, otherwise);
  if (endpoint && endpoint->port >= least_port) return *endpoint;
  throw CLI::ValidationError(
      name, quote(text) + " is not " + form + " (port " + std::to_string(least_port) + "..65535)");
}

CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         std::uint16_t least_port, const std::string& form,
                         const std::string& help) {
  const auto set = [&value, otherwise = value, name, least_port, form](const std::string& text) {
    value = parseEndpointOr(text, otherwise, name, least_port, form);
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(form.substr(0, form.find_first_of(" ,")))
      ->default_str(value.host.empty() ? "" : toString(value));
}

void showDefault(CLI::Option& option, double value) {
  std::ostringstream text;
  text << std::setprecision(12) << value;
  option.default_str(text.str());
}

template <class Number>
CLI::ValidationError notANumber(const std::string& name, const std::string& text, Number least,
                                Number most) {
  std::ostringstream form;
  form << std::setprecision(12) << (std::is_integral_v<Number> ? "a whole number" : "a number")
       << " from " << least << " to " << most;
  return CLI::ValidationError(name, quote(text) + " is not " + form.str());
}
template CLI::ValidationError notANumber(const std::string&, const std::string&, double, double);
template CLI::ValidationError notANumber(const std::string&, const std::string&, std::uint64_t,
                                         std::uint64_t);

CLI::Option* addLocalPort(CLI::App& app, const std::string& name, std::optional<Endpoint>& value,
                          const std::string& help) {
  const auto set = [&value, name](const std::string& text) {
    // Whether the text has a port: without one the port is that of the default.
    const auto one = parseEndpoint(text, {"127.0.0.1", 1}),
               two = parseEndpoint(text, {"127.0.0.1", 2});
    if (!one || !two || one->port != two->port)
      throw CLI::ValidationError(name, quote(text) + " is not [ADDR:]PORT (port 0..65535)");
    value = one;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name("[ADDR:]PORT");
}

CLI::Option* addLive(CLI::App& app, std::optional<Endpoint>& value) {
  return addLocalPort(
      app, "--live", value,
      "Show the messages of a recording while they are made, to Lichtblick, Foxglove and other "
      "programs with Foxglove's WebSocket protocol; ADDR: an IP address of this machine, default: "
      "127.0.0.1; everyone who reaches it may watch; port 0: any free port; usual: 8765");
}

CLI::Option* addPair(CLI::App& app, const std::string& name,
                     const std::function<bool(const Vec2&)>& set_pair, const std::string& form,
                     const std::string& help) {
  const auto set = [set_pair, name, form](const std::string& text) {
    const auto pair = parsePair(text);
    if (!pair || !set_pair(*pair))
      throw CLI::ValidationError(name, quote(text) + " is not " + form);
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(form.substr(0, form.find(' ')));
}

std::string lastName(const std::string& names) { return names.substr(names.rfind(',') + 1); }

CLI::Option* addFile(CLI::App& app, const std::string& name, std::string& file,
                     const std::string& ending, const std::string& help) {
  const auto set = [&file, flag = lastName(name), ending](const std::string& text) {
    if (!hasEnding(text, ending))
      throw CLI::ValidationError(flag + " " + text,
                                 "does not end with " + ending + "; use FILE" + ending);
    file = text;
  };
  return app.add_option_function<std::string>(name, set, help)->type_name("FILE" + ending);
}

void addVersion(CLI::App& app, const std::string& built_in) {
  const std::string text = app.get_name() + " " HAPTICAST_VERSION " (" + built_in +
                           ")\noptional packages: " HAPTICAST_OPTIONAL;
  app.set_version_flag("--version", text);
  app.footer(text);
}

namespace {

/// Returns the key of an option in a config file.
std::string findKey(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : option.get_lnames().front();
}

/// Returns `text` as comment lines of at most 100 columns.
std::string makeComment(const std::string& text) {
  constexpr std::size_t kColumns = 100;
  std::string lines = "#";
  std::size_t column = lines.size();
  std::istringstream words(text);
  for (std::string word; words >> word; column += 1 + word.size()) {
    if (column > 1 && column + 1 + word.size() > kColumns) {
      lines += "\n#";
      column = 1;
    }
    lines += " " + word;
  }
  return lines + "\n";
}

/// Replaces CLI11's own reader, which accepts sections, nests them without a limit, and loses a key
/// that occurs again further down.
class KeyValueConfig : public CLI::ConfigBase {
 public:
  explicit KeyValueConfig(const CLI::App& app) : app_(app) {}

  [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    // CLI11 2.4 reads several files, one after the other.
    if (app_.get_config_ptr()->count() > 1) throw CLI::ArgumentMismatch("--config: several files");
    const auto pairs = readKeyValues(in, "");
    if (!pairs.ok()) throw ConfigFileError(pairs.error().message);
    std::vector<CLI::ConfigItem> items;
    for (const KeyValue& pair : pairs.value()) {
      const CLI::App* const owner = findOwnerOf(pair);
      if (owner == nullptr) continue;
      const auto same = std::find_if(items.begin(), items.end(),
                                     [&](const auto& item) { return item.name == pair.key; });
      CLI::ConfigItem& item = same != items.end() ? *same : items.emplace_back();
      item.name = pair.key;
      if (owner != &app_) item.parents = {owner->get_name()};
      item.inputs.push_back(pair.value);
    }
    return items;
  }

 private:
  /// Returns the parser that has the key: the subcommand or the program. Returns null for a key of
  /// another subcommand, because one file serves all. Throws for an unknown key.
  [[nodiscard]] const CLI::App* findOwnerOf(const KeyValue& pair) const {
    const auto complain = [&](const std::string& what) {
      throw ConfigFileError(":" + std::to_string(pair.line) + ": " + what);
    };
    if (pair.key == "config") complain("a config file cannot name another one");
    std::vector<const CLI::App*> apps(1, &app_);
    const auto chosen = app_.get_subcommands();
    apps.insert(apps.begin(), chosen.begin(), chosen.end());
    std::vector<std::string> keys;
    for (const CLI::App* const app : apps) {
      for (const CLI::Option* const option : app->get_options()) {
        if (!option->get_configurable()) continue;
        if (option->check_lname(pair.key) || option->check_name(pair.key)) return app;
        keys.push_back(findKey(*option));
      }
    }
    for (const std::string& name : {"--" + pair.key, pair.key}) {
      if (!findOwner(app_, name, *apps.front()).empty()) return nullptr;
    }
    if (const auto owner = ownerOfFlag(pair.key, app_.get_name()); !owner.empty())
      complain(quote(pair.key) + " is a flag of " + std::string(owner));
    complain(quote(pair.key) + " is not the name of a flag" + spellingHint(pair.key, keys));
    return nullptr;
  }

  const CLI::App& app_;
};

}  // namespace

void addConfigFile(CLI::App& app, const std::string& default_file) {
  std::string help = "File of KEY = VALUE lines; every flag is a key of the same name";
  if (!default_file.empty()) help += "; default: " + default_file + ", if it exists";
  app.set_config("--config", default_file, help)->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<KeyValueConfig>(app));
  const auto print = [&app] {
    throw CLI::CallForVersion(writeConfig(app), CLI::ExitCodes::Success);
  };
  app.add_flag_callback("--print-config", print,
                        "Print a config file with every flag and its default as a comment, and end")
      ->configurable(false);
}

std::string writeConfig(const CLI::App& app) {
  std::string text = makeComment("Configuration of " + app.get_name() +
                                 ": KEY = VALUE lines. Each key is a flag of the command line, "
                                 "which wins over this file. A line without a value has no fixed "
                                 "default. Remove the # in front of a key to set it.");
  std::vector<const CLI::App*> apps = app.get_subcommands({});
  apps.push_back(&app);
  std::set<std::string> written;
  for (const CLI::App* const each : apps) {
    for (const CLI::Option* const option : each->get_options()) {
      if (!option->get_configurable() || !written.insert(findKey(*option)).second) continue;
      const bool is_switch = option->get_items_expected_max() == 0;
      const std::string value = is_switch ? "false" : option->get_default_str();
      text += "\n" + makeComment(option->get_description());
      if (!is_switch) text += makeComment("Value: " + option->get_type_name());
      text += "#" + findKey(*option) + " =" + (value.empty() ? "" : " " + value) + "\n";
    }
  }
  return text;
}

}  // namespace hapticast
