// SPDX-License-Identifier: MIT
#include "server/source/recording/message_types.hpp"

#include <cmath>

namespace hapticast::server {

std::int64_t toStamp_ns(std::int64_t seconds, std::int64_t nanoseconds) {
  constexpr std::int64_t kMost_s = std::int64_t{1} << 33U;  // the year 2242
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const bool valid =
      seconds >= 0 && seconds <= kMost_s && nanoseconds >= 0 && nanoseconds < kSecond_ns;
  return valid ? seconds * kSecond_ns + nanoseconds : 0;
}

std::optional<CameraMessage> withMatrix(CameraMessage camera, std::span<const double, 9> k) {
  constexpr double kMost_px = 1e5;
  const auto isFocal = [](double value) { return value >= 1.0 && value <= kMost_px; };
  const auto isCentre = [](double value) { return std::abs(value) <= kMost_px; };
  if (!isFocal(k[0]) || !isFocal(k[4]) || !isCentre(k[2]) || !isCentre(k[5])) return std::nullopt;
  camera.camera = {k[0], k[4], k[2] + 0.5, k[5] + 0.5};
  return camera;
}

}  // namespace hapticast::server
