// SPDX-License-Identifier: MIT
#include "client/settings/command_line.hpp"

#include <array>
#include <stdexcept>

#include "client/device/open_device.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "client/settings/subcommand_options.hpp"
#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"

namespace hapticast::client {

namespace {

// The package hapticast-client installs it.
constexpr const char* kSystemConfig = "/etc/hapticast/client.conf";

constexpr auto kSubcommandFlags = std::to_array<SubcommandFlag>({{"--control", "control"},
                                                                 {"--study", "study"},
                                                                 {"--replay", "replay"},
                                                                 {"--falcon-calibrate", "check"},
                                                                 {"--check-device", "check"},
                                                                 {"--list-devices", "list"},
                                                                 {"--list", "list"}});

/// For --version: the kinds of views, devices and transports of this build.
std::string listOptionalParts() {
  std::string text = "views: screenshot film";
  if (kHasSound) text += " sound";
  text += kHasWindow ? " window; devices:" : "; devices:";
  for (const DeviceKind& kind : deviceKinds()) text += std::string(" ") + kind.name;
  text += "; transports:";
  for (const Transport each : {Transport::kGroup, Transport::kTcp, Transport::kDatagrams})
    text += std::string(" ") + transportName(each);
  return text.append(kHasDiscovery ? "; discovery: Avahi" : "; discovery: none");
}

}  // namespace

constinit const SubcommandChoice kSubcommandChoice{"touch", kSubcommandFlags};

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Lets a haptic device touch the objects that hapticast-server streams. Ctrl-C ends the "
      "client with the force at zero. Without a SUBCOMMAND it touches: `hapticast-client touch "
      "--help` has the flags.",
      "hapticast-client");
  addVersion(*app, listOptionalParts());
  app->require_subcommand(1);
  addTouchCommand(*app, settings);
  addReplayCommand(*app, settings);
  addStudyCommand(*app, settings);
  addCheckCommand(*app, settings);
  addListCommand(*app, settings);
  addControlCommand(*app, settings);
  app->set_help_all_flag("--help-all", "Print the help of every subcommand, and end");
  app->add_flag("--quiet", settings.quiet, "Only warnings and errors");
  addConfigFile(*app, kSystemConfig);
  return app;
}

std::optional<int> readCommandLine(Settings& settings, int argc, const char* const* argv) {
  const auto app = commandLine(settings);
  const auto exit_code = parseCommandLine(*app, argc, argv, kSubcommandChoice);
  if (exit_code) return exit_code;
  const std::string config = app->get_config_ptr()->as<std::string>();
  if (config != kSystemConfig) settings.config_file = config;
  return std::nullopt;
}

void requireVirtualHand(const Settings& settings) {
  if (!settings.hand_given || settings.device == "auto" || settings.device == "virtual") return;
  throw std::runtime_error("--hand " + settings.hand +
                           ": moves only the virtual device, but --device is " + settings.device +
                           "; remove --hand, or use --device virtual");
}

}  // namespace hapticast::client
