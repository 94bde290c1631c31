// SPDX-License-Identifier: MIT
// Media clock of an edge. (An edge is a server that forwards the stream of another server, the
// origin.) The clock follows the media clock of the origin: it adds an offset to the local clock.
// Pings over NATS measure this offset. Thread: any.
#pragma once

#include <atomic>
#include <cstdint>

#include "common/time.hpp"

namespace hapticast::server {

/// Local clock plus the measured offset.
class RelayClock final : public MediaClock {
 public:
  /// The offset is 0 until set(). `clock` must outlive this object.
  explicit RelayClock(const Clock& clock) : clock_(clock) {}

  [[nodiscard]] MediaTime now() const noexcept override {
    return MediaTime(clock_.now().time_since_epoch() + Duration(offset_ns_.load()));
  }
  [[nodiscard]] Duration errorBound() const noexcept override { return Duration(error_ns_.load()); }
  /// Sets the offset (media clock minus local clock) and its largest possible error.
  void set(Duration offset, Duration error) noexcept {
    offset_ns_.store(offset.count());
    error_ns_.store(error.count());
  }

 private:
  const Clock& clock_;
  std::atomic<std::int64_t> offset_ns_{0};
  std::atomic<std::int64_t> error_ns_{0};
};

}  // namespace hapticast::server
