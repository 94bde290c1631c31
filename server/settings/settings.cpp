// SPDX-License-Identifier: MIT
#include "server/settings/settings.hpp"

#include <algorithm>

#include "common/recording/mcap_reader.hpp"
#include "common/recording/progress_log.hpp"
#include "common/text.hpp"

namespace hapticast::server {

bool isRecording(const Settings& settings) {
  if (settings.source.find("://") != std::string::npos ||
      !hasEnding(settings.source, kRecordingEnding))
    return false;
  // The log is quiet later only.
  const ReadProgress progress = settings.quiet ? ReadProgress{} : logScan(settings.source);
  const auto reader = McapReader::open(settings.source, progress, 1);
  if (!reader.ok()) return false;  // openSource() says why
  const auto& channels = reader.value().channels();
  return std::any_of(channels.begin(), channels.end(), [](const auto& channel) {
    return channel.second.schema.name == "hapticast.proto.HapticFrame";
  });
}

bool isEdge(const Settings& settings) { return settings.source.starts_with(kNatsScheme); }

}  // namespace hapticast::server
