// SPDX-License-Identifier: MIT
#include "server/settings/command_line.hpp"

#include <array>
#include <string>

#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "server/settings/subcommand_options.hpp"

namespace hapticast::server {

namespace {

constexpr auto kSubcommandFlags =
    std::to_array<SubcommandFlag>({{"--preview", "preview"}, {"--source", "relay", kNatsScheme}});

}  // namespace

constinit const SubcommandChoice kSubcommandChoice{"serve", kSubcommandFlags};

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Turns RGB-D video into haptic frames and streams them to hapticast-client. Ctrl-C ends the "
      "server. Without a SUBCOMMAND it serves: `hapticast-server serve --help` has the flags.",
      "hapticast-server");
  addVersion(*app, std::string("sources: synthetic, images, videos, cameras; transports: udp, "
                               "multicast, tcp; discovery: ") +
                       (kHasDiscovery ? "Avahi" : "none") +
                       "; relays: " + (kHasRelays ? "NATS" : "none") +
                       "; camera libraries: " + (kHasOpenni ? "OpenNI2" : "none"));
  app->require_subcommand(1);
  addServeCommand(*app, settings);
  addPreviewCommand(*app, settings);
  addBakeCommand(*app, settings);
  addRelayCommand(*app, settings);
  app->set_help_all_flag("--help-all", "Print the help of every subcommand, and end");
  app->add_flag("--quiet", settings.quiet, "Only warnings and errors");
  addConfigFile(*app);
  return app;
}

std::optional<int> readCommandLine(Settings& settings, int argc, const char* const* argv) {
  const auto app = commandLine(settings);
  return parseCommandLine(*app, argc, argv, kSubcommandChoice);
}

Result<Settings> rereadCommandLine(int argc, const char* const* argv) {
  Settings settings;
  const auto app = commandLine(settings);
  if (const auto problem = parseArguments(*app, argc, argv, kSubcommandChoice))
    return Error{*problem};
  return settings;
}

}  // namespace hapticast::server
