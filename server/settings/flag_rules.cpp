// SPDX-License-Identifier: MIT
#include "server/settings/flag_rules.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "common/recording/mcap_reader.hpp"
#include "common/text.hpp"
#include "server/settings/child_options.hpp"

namespace hapticast::server {

namespace {

/// Throws CLI::ValidationError for flags of the network that need another one.
void requireNetworkFlags(const Settings& settings) {
  const TlsFiles& tls = settings.tls;
  if (tls.certificate.empty() != tls.key.empty())
    throw CLI::ValidationError(tls.key.empty() ? "--tls-cert" : "--tls-key",
                               "--tls-cert and --tls-key belong together");
  if (tls.automatic && !tls.certificate.empty())
    throw CLI::ValidationError("--tls", "auto and --tls-cert exclude each other");
  if (settings.insecure && settings.tokens_file.empty())
    throw CLI::ValidationError("--insecure", "needs --tokens");
  if (!settings.host_names.empty() && !settings.http && !settings.page)
    throw CLI::ValidationError("--host-name", "needs the page (--page on) or --http");
}

/// Returns the first flag that was set and that a server without vision cannot obey; empty if there
/// is none. `more`: flags that this server can obey besides those of every server.
std::string findVisionFlag(const CLI::App& app, const std::vector<std::string>& more) {
  const std::vector<std::string> allowed{
      "--source",      "--listen",   "--transport",  "--multicast",  "--multicast-ttl",
      "--max-clients", "--announce", "--tls-cert",   "--tls-key",    "--tls",
      "--tokens",      "--insecure", "--nats-creds", "--nats-ca",    "--quiet",
      "--config",      "--http",     "--host-name",  "--origin-key", "--page"};
  for (const CLI::Option* option : app.get_options()) {
    std::string name = option->get_name();
    const auto isIn = [&name](const std::vector<std::string>& flags) {
      return std::find(flags.begin(), flags.end(), name) != flags.end();
    };
    if (option->count() > 0 && !isIn(allowed) && !isIn(more)) return name;
  }
  return "";
}

/// Refuses each flag that only a server with a stream of its own can obey.
void requireEdgeFlags(const CLI::App& app) {
  const std::string name = findVisionFlag(app, {});
  if (name.empty()) return;
  throw CLI::ValidationError(
      name, name == "--publish"
                ? "an edge publishes nothing; clusters and leaf nodes of NATS pass streams on"
                : "an edge forwards an origin's stream; give this flag to the origin");
}

/// Refuses each flag that changes what a recording has already.
void requireRecordingFlags(const CLI::App& app) {
  const std::string name =
      findVisionFlag(app, {"--publish", "--signing-key", "--loop", "--frames", "--wait-for-viewer",
                           "--name", "--record", "--live", "--on-demand"});
  if (!name.empty())
    throw CLI::ValidationError(name,
                               "a recording has its frames already; give this flag to the "
                               "server that records");
}

/// Refuses the flags that contradict --on-demand. Each viewer then receives by TCP.
void requireOnDemandFlags(const CLI::App& app, Settings& settings) {
  if (!settings.on_demand) return;
  if (!hasEnding(settings.source, kRecordingEnding))
    throw CLI::ValidationError("--on-demand", "needs --source FILE.mcap");
  const bool wants_datagrams = app.count("--transport") > 0 && settings.datagrams;
  settings.datagrams = false;
  if (wants_datagrams) throw CLI::ValidationError("--transport", "--on-demand sends by TCP only");
  for (const char* const name :
       {"--multicast", "--publish", "--record", "--live", "--frames", "--wait-for-viewer"}) {
    if (app.count(name) > 0)
      throw CLI::ValidationError(name, "with --on-demand there is no stream for all viewers");
  }
  if (settings.is_recording) return;
  const auto reader = McapReader::open(settings.source, 1);
  throw CLI::ValidationError("--source", settings.source + ": " +
                                             (reader.ok() ? "is no recording that --record has made"
                                                          : reader.error().message));
}

}  // namespace

void requireFlags(const CLI::App& app, Settings& settings) {
  requireNetworkFlags(settings);
  requireChildFlags(app, settings);
  if (!isEdge(settings) && !settings.origin_keys.empty() && !settings.publish)
    throw CLI::ValidationError("--origin-key", "needs --source nats://... or --publish");
  settings.is_recording = isRecording(settings);
  if (settings.is_recording) {
    requireRecordingFlags(app);
  } else if (isEdge(settings)) {
    requireEdgeFlags(app);
  }
  requireOnDemandFlags(app, settings);
}

bool isRecording(const Settings& settings) {
  if (settings.source.find("://") != std::string::npos ||
      !hasEnding(settings.source, kRecordingEnding))
    return false;
  const auto reader = McapReader::open(settings.source, 1);
  if (!reader.ok()) return false;  // openSource() says why
  const auto& channels = reader.value().channels();
  return std::any_of(channels.begin(), channels.end(), [](const auto& channel) {
    return channel.second.schema.name == "hapticast.proto.HapticFrame";
  });
}

bool isEdge(const Settings& settings) { return settings.source.starts_with(kNatsScheme); }

}  // namespace hapticast::server
