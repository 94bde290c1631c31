// SPDX-License-Identifier: MIT
// The loop of the helper process between a driver and the shared page. One tick:
//   1. The driver waits for the device's tick (without wait(): a timer of 1 ms).
//   2. exchange() commands the newest force and returns a reading. The page passes it to the
//   client.
//   3. The loop waits briefly for the client's force of this reading, and commands it at once.
// A second thread calls monitor(), which commands zero if a call of the driver hangs.
// Thread: each function states its own.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "client/device/hapticast_device.h"
#include "client/device/helper/program/force_gate.hpp"
#include "client/device/helper/shared_page.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// The loop of one opened device. `driver`, `device`, `page` and `clock` must outlive it.
class HelperLoop {
 public:
  HelperLoop(const hapticast_driver& driver, hapticast_device* device, SharedPage& page,
             const Clock& clock);

  /// Runs ticks until end() was called and the force is zero. Thread: the loop's.
  void run() noexcept;
  /// Makes run() end within some 12 ms, after the force has descended to zero. Thread: any.
  void end() noexcept { ending_.store(true, std::memory_order_relaxed); }
  /// Returns true after the end of run(). Thread: any.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// Commands zero if the present call of the driver has lasted more than 20 ms while a force acts.
  /// Returns the duration of the present call, or 0 without a call. Thread: one other than the
  /// loop's.
  Duration monitor() noexcept;

 private:
  void tick(LocalTime deadline) noexcept;
  void wait(LocalTime deadline) noexcept;
  void exchange() noexcept;
  void warn() noexcept;
  void publish(const hapticast_state& state) noexcept;
  void beginCall() noexcept;
  Duration endCall() noexcept;

  const hapticast_driver& driver_;
  hapticast_device* device_;
  SharedPage& page_;
  const Clock& clock_;
  ForceGate gate_;
  DeviceCommand command_;
  DeviceReading reading_;
  std::array<std::int64_t, 8> taken_ns_{};  // of the last readings, by number
  bool warns_ = false;                      // the driver shows a safety state
  std::uint64_t handed_over_ = 0;           // newest reading whose force the driver has
  std::atomic<bool> ending_{false};
  std::atomic<bool> ended_{false};
  std::atomic<bool> force_acts_{false};
  std::atomic<std::int64_t> call_began_ns_{0};  // 0: no call
};

}  // namespace hapticast::client
