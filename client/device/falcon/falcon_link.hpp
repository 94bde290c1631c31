// SPDX-License-Identifier: MIT
// Connection to a Falcon: opens it, loads its firmware, streams replies, detects its loss and
// reopens it. At any end the last request sets the motors to zero, as long as the device receives
// data.
// Threads: loop, main, and one of its own for USB; each function states its own.
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
#include "client/device/open_device.hpp"
#include "client/haptics/haptic_device.hpp"
#include "common/sync/spsc_ring.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// A reply with its arrival.
struct FalconNews {
  FalconReply reply;
  LocalTime at;
  std::uint32_t life = 0;  ///< changes after each loss of the device
};

/// The connection; runs a thread until its destructor.
class FalconLink {
 public:
  using LogLine = std::function<void(const std::string& line)>;

  /// Opens the device and loads its firmware if necessary, with progress lines to `tell`. Throws
  /// FalconError if no device answers, std::runtime_error for an invalid firmware file. `clock`
  /// must outlive this object.
  FalconLink(FalconSettings settings, const Clock& clock, const LogLine& log_line);
  /// Sets the motors to zero, waits for the reply, and closes the device.
  ~FalconLink();
  FalconLink(const FalconLink&) = delete;
  FalconLink& operator=(const FalconLink&) = delete;

  // Thread: loop.

  /// Returns true while the device answers.
  [[nodiscard]] bool there() const noexcept { return there_.load(std::memory_order_acquire); }
  /// Fetches the oldest reply. Returns false if there is none. Does not block.
  bool popEvent(FalconNews& event) noexcept { return ring_.tryPop(event); }
  /// Queues a request on USB. Call outside the tick.
  void send(const FalconRequest& request) noexcept;
  /// Waits for the next reply, at most until `deadline`. Returns false after a timeout. Call
  /// outside the tick.
  bool waitForReply(LocalTime deadline) noexcept;

  // Thread: any.
  [[nodiscard]] DeviceTraffic traffic() const noexcept;
  /// Returns the next line for the user; nullopt: none. Thread: main.
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
  std::mutex usb_mutex_;      // never locked in the tick
  FalconUsb* usb_ = nullptr;  // guarded by usb_mutex_; null: send() does nothing
  std::atomic<bool> there_{false};
  std::atomic<bool> stop_{false};
  SpscRing<FalconNews, 64> ring_;
  sem_t replied_{};
  FalconParser parser_;     // the link's thread
  std::uint32_t life_ = 0;  // the link's thread
  LocalTime last_reply_{};  // the link's thread
  std::atomic<std::int64_t> last_sent_ns_{0};
  std::atomic<bool> torque_sent_{false};  // the last sent request was not zero
  std::atomic<std::uint64_t> round_trips_{0};
  std::atomic<std::uint64_t> misses_{0};
  std::atomic<std::uint64_t> resyncs_{0};
  std::mutex messages_mutex_;
  std::deque<std::string> messages_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::client
