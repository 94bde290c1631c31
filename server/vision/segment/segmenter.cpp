// SPDX-License-Identifier: MIT
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

void throwNoObject(const Vec2& point_px, const std::string& why) {
  throw SourceError("--object " + std::to_string(static_cast<int>(point_px.x())) + "," +
                    std::to_string(static_cast<int>(point_px.y())) + ": " + why +
                    "; choose a point well inside the object in the first frame");
}

}  // namespace hapticast::server
