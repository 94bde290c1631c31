// SPDX-License-Identifier: MIT
// The subcommands without a stream: check, list and control.
#include <string>

#include "client/device/open_device.hpp"
#include "client/settings/control_request.hpp"
#include "client/settings/device_options.hpp"
#include "client/settings/server_options.hpp"
#include "client/settings/subcommand_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/cli/subcommands.hpp"
#include "common/text.hpp"

namespace hapticast::client {

void addCheckCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(
      program, "check",
      "Check that the motion of a device follows its commands and fits its profile (mass, delay, "
      "count). Let go of the grip: it is pushed with 0.3 N");
  addDeviceKind(app, "DEVICE,--check-device", settings.check_device, "The device; default: auto");
  addDriverOptions(app, settings);
  addNumber(
      app, "--falcon-calibrate,--calibrate", settings.calibration_g, 50.0, 500.0, "GRAMS",
      "In place of the check: measure the gain of a Falcon with a known weight, step by step; "
      "the file of --config stores the gain, else the log shows it");
  app.final_callback([&settings] { settings.command = Command::kCheck; });
}

void addListCommand(CLI::App& program, Settings& settings) {
  CLI::App& app =
      addSubcommand(program, "list",
                    "List the servers that are announced on the LAN. The exit code is 0, "
                    "or 1 if there is none");
  app.add_flag("--list-devices,--devices", settings.list_devices,
               "In place of servers: list the kinds of devices and the connected devices");
  app.add_flag("--list", settings.list_servers, "The default");
  addDriverOptions(app, settings);
  app.final_callback([&settings] {
    settings.command = Command::kList;
    if (!settings.list_devices) requireDiscovery("list");
  });
}

void addControlCommand(CLI::App& program, Settings& settings) {
  CLI::App& app =
      addSubcommand(program, "control", "Send a server the request of an operator (--token-file)");
  const auto set_control = [&settings](const std::string& request) {
    settings.control = parseControl(request);
    if (!settings.control) {
      throw CLI::ValidationError("--control", quote(request) +
                                                  " is not pause, play, seek=SECONDS or "
                                                  "stiffness|damping|texture-depth|mass=NUMBER or "
                                                  "friction=STATIC:DYNAMIC, joined by commas");
    }
  };
  app.add_option_function<std::string>(
         "REQUEST,--control", set_control,
         "pause, play, seek=SECONDS, speed=FACTOR (0.1..4, of a recording), stiffness=, damping=, "
         "texture-depth=, mass=, friction=STATIC:DYNAMIC")
      ->type_name("REQUEST[,...]")
      ->required();
  addServerOptions(app, settings);
  app.final_callback([&settings] { settings.command = Command::kControl; });
}

}  // namespace hapticast::client
