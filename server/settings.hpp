// SPDX-License-Identifier: MIT
// hapticast-server's settings and their defaults. command_line.hpp reads them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/endpoint.hpp"
#include "server/stream/multicast_choice.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

struct Settings {
  std::string source;
  double fps = 0.0;  ///< 0: the source's own
  bool loop = false;
  bool wait_for_viewer = false;
  std::uint64_t frames = 0;  ///< stop after so many; 0: no limit
  Endpoint listen{"0.0.0.0", kDefaultPort};
  bool datagrams = true;  ///< --transport udp
  std::optional<MulticastChoice> multicast;
  std::uint64_t multicast_hops = 1;
  std::size_t max_clients = 64;
  std::string announce;  ///< by which name on the LAN; empty: not at all
  std::string name;      ///< what viewers see; empty: the source's own
  VisionSettings vision;
  std::string preview;  ///< FILE.png or a folder to show what was taken; empty: stream
  bool explain = false;
  bool quiet = false;
};

/// By how much a height may be wrong on the wire, so that the force is by no more than the budget:
/// the default budget at the usual stiffness gives kDefaultHeightError_mm.
[[nodiscard]] double heightError_mm(const VisionSettings& vision);

}  // namespace hapticast::server
