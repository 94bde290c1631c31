// SPDX-License-Identifier: MIT
// Config files of both programs and the values of flags: any text is taken or refused with a
// CLI::ParseError, and what is taken is within the limits that the flags promise.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <iterator>
#include <memory>
#include <string>

#include "client/settings/command_line.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/wire_limits.hpp"
#include "server/settings/command_line.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::settings {
namespace {

/// A command line, which takes milliseconds to build, for many texts.
template <class Settings, auto kCommandLine>
struct Program {
  explicit Program(const char* subcommand) : name(subcommand) {}

  /// Reads `text` as the config file of the subcommand.
  bool accepts(const std::string& text) {
    settings = {};
    app->clear();
    const int file = ::memfd_create("config", 0);
    require(file >= 0 && ::write(file, text.data(), text.size()) == ssize_t(text.size()));
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    const char* const arguments[] = {"program", name, "--config", path.c_str()};
    bool accepted = true;
    try {
      app->parse(static_cast<int>(std::size(arguments)), arguments);
    } catch (const CLI::ParseError&) {
      accepted = false;
    }
    ::close(file);
    return accepted;
  }
  const char* name;
  Settings settings;
  std::unique_ptr<CLI::App> app = kCommandLine(settings);
};

void server(const std::string& text) {
  static Program<hapticast::server::Settings, hapticast::server::commandLine> program("serve");
  if (!program.accepts(text)) return;
  const auto& settings = program.settings;
  require(settings.fps == 0.0 || (settings.fps >= 1.0 && settings.fps <= 240.0));
  require(settings.max_clients >= 1 && settings.max_clients <= 10'000);
  require(!settings.listen.host.empty());
  require(!settings.http || !settings.http->host.empty());
  const auto& vision = settings.vision;
  require(!vision.mass_kg || (*vision.mass_kg >= 0.001 && *vision.mass_kg <= 100.0));
  for (const auto& points : {vision.object_points, vision.not_points}) {
    for (const auto& point : points)
      require(point.at_px.allFinite() && point.time_s >= 0.0 && point.time_s <= 1e6);
  }
}

void client(const std::string& text) {
  static Program<hapticast::client::Settings, hapticast::client::commandLine> program("touch");
  if (!program.accepts(text)) return;
  const auto& settings = program.settings;
  require(settings.seconds >= 0.0 && settings.seconds <= 1e8);
  require((settings.device == "virtual" || settings.device == "auto") &&
          settings.delivery.copies <= hapticast::limits::kMostCopies);
  require(!settings.server.host.empty());
}

}  // namespace

HAPTICAST_FUZZ_TARGET("settings") {
  const std::string text(reinterpret_cast<const char*>(data), size);
  server(text);
  client(text);
  if (const auto endpoint = hapticast::parseEndpoint(text, {"here", 1}))
    require(!endpoint->host.empty());
  if (const auto pair = hapticast::parsePair(text)) require(pair->allFinite());
  return 0;
}

}  // namespace hapticast::fuzz::settings
