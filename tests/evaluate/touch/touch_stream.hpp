// SPDX-License-Identifier: MIT
// A touch scene through the real server and over the wire: enhancement and motion of class Vision,
// then the bytes that a viewer would get. Thread: any, each call for itself.
#pragma once

#include <vector>

#include "common/codec/height_codec.hpp"
#include "common/transport/framing.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/relief_scene.hpp"

namespace hapticast::evaluate {

/// How the server makes the stream; the rest to see where an error comes from.
struct StreamKind {
  Method method = Method::kHapticast;
  Seen seen;
  bool exact_pose = false;  ///< vision's motion is replaced by the truth
  double longest_s = 1e9;   ///< the scene ends here
  bool scan = false;        ///< the clip is looked through first, for its largest acceleration
  bool offline = false;     ///< as `hapticast-server bake` does
  Material material;
  std::optional<double> mass_kg;
  /// As fine as slices go: what they add at their default is measured by the topic codec.
  SliceSettings slices{.error_mm = 0.001};
};

struct Stream {
  struct Bytes {
    double time_s = 0.0;
    SharedBytes message;  ///< with its length prefix
  };
  StreamDescription description;
  std::vector<Bytes> frames;
  double mask_error_px = 0.0;  ///< area between the masks per length of the true one's edge
  double server_us = 0.0;      ///< of vision and encoder, per frame, one thread
};

Stream makeStream(const TouchScene& scene, const StreamKind& kind);
/// Any source; `scan`: looked through first.
Stream makeStream(server::RgbdSource& source, const server::VisionSettings& settings, bool scan);

}  // namespace hapticast::evaluate
