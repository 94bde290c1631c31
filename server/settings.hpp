// SPDX-License-Identifier: MIT
// Settings of hapticast-server and their defaults; command_line.hpp fills them. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/endpoint.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// One member for each flag; see --help.
struct Settings {
  std::string source;
  double fps = 0.0;  ///< 0: the source's own
  bool loop = false;
  bool wait_for_viewer = false;
  std::uint64_t frames = 0;  ///< frames to stream; 0: no limit
  Endpoint listen{"0.0.0.0", kDefaultPort};
  bool datagrams = true;  ///< --transport udp
  std::optional<MulticastChoice> multicast;
  std::uint64_t multicast_hops = 1;
  std::size_t max_clients = 64;
  std::string announce;  ///< name on the LAN; empty: no announcement
  std::string name;      ///< stream name for viewers; empty: the source's own
  VisionSettings vision;
  std::string preview;  ///< preview: FILE.png or a folder; empty: stream
  bool explain = false;
  bool quiet = false;
};

/// Returns the largest error of heights on the wire, mm, for which the force stays within the error
/// budget. The default budget at the usual stiffness yields kDefaultHeightError_mm.
[[nodiscard]] double heightError_mm(const VisionSettings& vision);

}  // namespace hapticast::server
