// SPDX-License-Identifier: MIT
#include "client/settings/device_options.hpp"

#include <algorithm>
#include <functional>
#include <string_view>

#include "client/device/falcon/falcon_settings.hpp"
#include "client/device/open_device.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

/// What --device takes: auto, and the kinds of this build.
const std::map<std::string, std::string>& devices() {
  static const auto kDevices = [] {
    std::map<std::string, std::string> names{{"auto", "auto"}};
    for (const std::string& name : deviceNames()) names.emplace(name, name);
    return names;
  }();
  return kDevices;
}

/// Returns a hint for the name of a product, for example "omni".
std::string productHint(const std::string& text) {
  const std::string word = " " + toLower(text) + " ";
  for (const DeviceKind& kind : deviceKinds()) {
    if ((" " + std::string(kind.products)).find(word) != std::string::npos)
      return std::string("; did you mean ") + kind.name + "?";
  }
  return "";
}

std::string deviceHelp() {
  std::string help =
      "The haptic device; auto (default): a connected device, else the mouse if there is a window, "
      "else virtual";
  for (const DeviceKind& kind : deviceKinds()) {
    help += std::string("; ") + kind.name + ": " + kind.description;
  }
  return help;
}

void addDriverOption(CLI::App& app, Settings& settings) {
  const auto add = [&settings](const std::string& text) {
    const std::size_t split = text.find('=');
    if (split == 0 || split == std::string::npos)
      throw CLI::ValidationError("--device-option", quote(text) + " is not KEY=VALUE");
    settings.device_options[text.substr(0, split)] = text.substr(split + 1);
  };
  app.add_option_function<std::vector<std::string>>(
         "--device-option",
         [add](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) add(text);
         },
         "A setting for the driver of the device; `serial` selects one of several devices. "
         "DRIVER.KEY=VALUE is for this driver only, e.g. falcon.gain=3500")
      ->type_name("[DRIVER.]KEY=VALUE");
}

bool hasDevice(std::string_view name) {
  const auto kinds = deviceKinds();
  return std::any_of(kinds.begin(), kinds.end(),
                     [name](const DeviceKind& kind) { return kind.name == name; });
}

/// Adds --falcon-KEY VALUE, which is --device-option falcon.KEY=VALUE. `check` throws for a wrong
/// value.
CLI::Option* addFalconOption(CLI::App& app, Settings& settings, const std::string& key,
                             const char* type, const char* help,
                             const std::function<void(const std::string& text)>& check = {}) {
  const auto set = [&settings, key, check](const std::string& text) {
    if (check) check(text);
    settings.device_options["falcon." + key] = text;
  };
  return app.add_option_function<std::string>("--falcon-" + key, set, help)->type_name(type);
}

void checkFalconGain(const std::string& text) {
  if (!parseFalconGain(text))
    throw notANumber("--falcon-gain", text, kLeastFalconGain, kMostFalconGain);
}

void addFalconOptions(CLI::App& app, Settings& settings) {
  if (!hasDevice("falcon")) return;
  addFalconOption(app, settings, "firmware", "FILE",
                  "The Falcon's firmware, a file of your own, loaded after each power-up; default: "
                  "hapticast/falcon.bin in $XDG_DATA_HOME, else in ~/.local/share");
  addFalconOption(app, settings, "serial", "S",
                  "Which Falcon, by its serial number (list --devices); default: the first");
  showDefault(*addFalconOption(app, settings, "gain", "COUNTS_PER_NM",
                               "Motor counts for a torque of 1 N m at an arm of the Falcon, "
                               "100..20000; default: 3500",
                               checkFalconGain),
              kFalconGain);
}

}  // namespace

CLI::Option* addDeviceKind(CLI::App& app, const std::string& name, std::string& kind,
                           const std::string& help) {
  return addChoice(app, name, kind, devices(), help, productHint);
}

void addStiffnessLimit(CLI::App& app, Settings& settings) {
  addNumber(app, "--stiffness-limit", settings.stiffness_limit_N_mm, 0.01, 1000.0, "N/MM",
            "The largest stiffness that an author may request; default: three times the profile's "
            "stiffness");
}

void addDriverOptions(CLI::App& app, Settings& settings) {
  addDriverOption(app, settings);
  app.add_option("--profile", settings.profile,
                 "The limits of the device: omni (default), falcon, or a file "
                 "of KEY = VALUE lines (keys: client/device/README.md, Profiles)")
      ->type_name("NAME|FILE")
      ->default_str(settings.profile);
  addFalconOptions(app, settings);
}

void addDeviceOptions(CLI::App& app, Settings& settings) {
  addDeviceKind(app, "--device", settings.device, deviceHelp());
  addDriverOptions(app, settings);
  app.add_option("--hand", settings.hand,
                 "The motion of the virtual hand: press (default; push with 1 N, hold, release, "
                 "repeat), slide (over the object, 1 mm deep), follow (move with the object), free "
                 "(the hand has released the grip), or a CSV file of t_s,x_mm,y_mm,z_mm targets in "
                 "nominal mm")
      ->each([&settings](const std::string& /*name*/) { settings.hand_given = true; })
      ->type_name("press|slide|follow|free|FILE.csv")
      ->default_str(settings.hand);
  addStiffnessLimit(app, settings);
  app.add_flag("--rearm", settings.rearm,
               "The force fades in automatically after a lost device answers again, or 5 s after "
               "the trust in a stream was lost (three times at most); without this flag, only R in "
               "the window or the next start restores it");
}

}  // namespace hapticast::client
