// SPDX-License-Identifier: MIT
// Keeps a Falcon: opens it, brings its firmware to life, streams replies, notices when it goes and
// opens it again. Whatever ends, the motors hear zero last, as long as the device hears anything.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/device/falcon/protocol.hpp"
#include "client/device/falcon/usb.hpp"
#include "client/device/falcon_settings.hpp"
#include "client/haptics/haptic_device.hpp"
#include "common/sync/spsc_ring.hpp"
#include "common/time.hpp"

namespace hapticast::client {

struct FalconNews {
  FalconReply reply;
  LocalTime at;
  std::uint32_t life = 0;  ///< another one: the device has been away in between
};

class FalconLink {
 public:
  using LogLine = std::function<void(const std::string& line)>;

  /// Opens it and loads its firmware if need be, telling how far it is. Throws FalconError where
  /// there is none that answers, std::runtime_error for a firmware file that is none. `clock`
  /// outlives it.
  FalconLink(FalconSettings settings, const Clock& clock, const LogLine& log_line);
  /// Tells the motors zero, waits until the device has answered, and lets it go.
  ~FalconLink();
  FalconLink(const FalconLink&) = delete;
  FalconLink& operator=(const FalconLink&) = delete;

  // Thread: loop.
  /// Whether the device is there.
  [[nodiscard]] bool there() const noexcept { return there_.load(std::memory_order_acquire); }
  /// Never blocks.
  bool popEvent(FalconNews& event) noexcept { return ring_.tryPop(event); }
  /// Hands a request to USB; outside the tick.
  void send(const FalconRequest& request) noexcept;
  /// Waits for the next reply, until `deadline` at most. Outside the tick.
  bool waitForReply(LocalTime deadline) noexcept;

  // Thread: any.
  [[nodiscard]] DeviceTraffic traffic() const noexcept;
  /// The next line for the user. Thread: main.
  std::optional<std::string> nextMessage();

 private:
  std::unique_ptr<FalconUsb> open(const LogLine& log_line);
  void initialise(std::unique_ptr<FalconUsb>& usb, const LogLine& log_line);
  void keepOpen(std::unique_ptr<FalconUsb> usb);
  void serve(FalconUsb& usb);
  void last_reply(std::span<const std::uint8_t> data);
  void watchLoop(FalconUsb& usb);
  void endWithZero(FalconUsb& usb);
  std::unique_ptr<FalconUsb> openAgain();
  void pushMessage(const std::string& line);

  FalconSettings settings_;
  const Clock& clock_;
  std::mutex usb_mutex_;      // not taken in the tick
  FalconUsb* usb_ = nullptr;  // guarded by it: what send() may use
  std::atomic<bool> there_{false};
  std::atomic<bool> stop_{false};
  SpscRing<FalconNews, 64> ring_;
  sem_t replied_{};
  FalconParser parser_;     // the link's thread
  std::uint32_t life_ = 0;  // the link's thread
  LocalTime last_reply_{};  // the link's thread
  std::atomic<std::int64_t> last_sent_ns_{0};
  std::atomic<bool> torque_sent_{false};  // the last request that went out was not zero
  std::atomic<std::uint64_t> round_trips_{0};
  std::atomic<std::uint64_t> misses_{0};
  std::atomic<std::uint64_t> resyncs_{0};
  std::mutex messages_mutex_;
  std::deque<std::string> messages_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::client
