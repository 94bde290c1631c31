// SPDX-License-Identifier: MIT
#include "common/cli/config_file.hpp"

#include <algorithm>
#include <istream>
#include <memory>
#include <vector>

#include "common/spelling.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

/// Replaces CLI11's own reader, which accepts sections, nests them without a limit, and loses a key
/// that occurs again further down.
class KeyValueConfig : public CLI::ConfigBase {
 public:
  explicit KeyValueConfig(const CLI::App& app) : app_(app) {}

  [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    const auto pairs = readKeyValues(in, "");
    if (!pairs.ok()) throw ConfigFileError(pairs.error().message);
    std::vector<CLI::ConfigItem> items;
    for (const KeyValue& pair : pairs.value()) {
      requireFlag(pair);
      const auto same = std::find_if(items.begin(), items.end(),
                                     [&](const auto& item) { return item.name == pair.key; });
      CLI::ConfigItem& item = same != items.end() ? *same : items.emplace_back();
      item.name = pair.key;
      item.inputs.push_back(pair.value);
    }
    return items;
  }

 private:
  void requireFlag(const KeyValue& pair) const {
    const auto complain = [&](const std::string& what) {
      throw ConfigFileError(":" + std::to_string(pair.line) + ": " + what);
    };
    if (pair.key == "config") complain("a config file cannot name another one");
    std::vector<std::string> keys;
    for (const CLI::Option* const option : app_.get_options()) {
      if (!option->get_configurable()) continue;
      if (option->check_lname(pair.key) || option->check_name(pair.key)) return;
      keys.push_back(option->get_lnames().empty() ? option->get_name()
                                                  : option->get_lnames().front());
    }
    complain(quote(pair.key) + " is no flag's name" + spellingHint(pair.key, keys));
  }

  const CLI::App& app_;
};

}  // namespace

void addConfigFile(CLI::App& app) {
  app.set_config("--config", "", "File of KEY = VALUE lines; every flag is a key of the same name")
      ->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<KeyValueConfig>(app));
}

}  // namespace hapticast
