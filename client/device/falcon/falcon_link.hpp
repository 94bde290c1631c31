// SPDX-License-Identifier: MIT
// Connection to a Falcon. It opens the device, loads its firmware, and passes the device's replies
// to the loop. If it loses the device, it opens the device again.
//
// The connection never leaves a device with a force. Before it closes the device, it sends requests
// for zero force and waits for their replies, at the end of the program as after a loss. It cannot
// do so if the device does not answer.
// Threads: loop, main, and a thread of the link for USB. Each function states its thread.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/device/falcon/falcon_settings.hpp"
#include "client/device/falcon/protocol.hpp"
#include "client/device/falcon/usb.hpp"
#include "client/haptics/haptic_device.hpp"
#include "common/sync/spsc_ring.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// A reply of the device and the time of its arrival.
struct FalconNews {
  FalconReply reply;
  LocalTime at;
  /// Number of the present connection to the device. It changes each time the device is opened
  /// again.
  std::uint32_t life = 0;
};

/// The connection to one Falcon. It runs a thread for USB until its destructor.
class FalconLink {
 public:
  using LogLine = std::function<void(const std::string& line)>;

  /// Opens the device, and loads its firmware if necessary. The link calls `log_line` with each
  /// line for the user: in this thread, and later in its own thread until the destructor ends.
  /// Throws FalconError if the device is missing, does not answer, or does not accept its firmware.
  /// Throws std::runtime_error for an invalid firmware file. `clock` must outlive this object.
  FalconLink(FalconSettings settings, const Clock& clock, LogLine log_line);
  /// Sets the motors to zero force, waits for the device's reply, and closes the device.
  ~FalconLink();
  FalconLink(const FalconLink&) = delete;
  FalconLink& operator=(const FalconLink&) = delete;

  // Thread: loop.

  /// Returns true while the device is open and answers.
  [[nodiscard]] bool there() const noexcept { return there_.load(std::memory_order_acquire); }
  /// Removes the oldest unread reply and writes it to `event`. Returns false if there is none. Does
  /// not block.
  bool popEvent(FalconNews& event) noexcept { return ring_.tryPop(event); }
  /// Queues a request for the transfer on USB. Does nothing if the device is not open, or if
  /// another thread uses the connection at that moment. Call it outside the tick.
  void send(const FalconRequest& request) noexcept;
  /// Waits for the next reply, at most until `deadline`. Returns true if a reply arrived, and false
  /// after a timeout. Call it outside the tick.
  bool waitForReply(LocalTime deadline) noexcept;

  // Thread: any.
  [[nodiscard]] DeviceTraffic traffic() const noexcept;
  /// Returns the serial number of the device. Thread: the constructor's.
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }
  /// Queues a request for zero force. Returns false if the device is not open or its queue is full.
  bool sendZero() noexcept;

 private:
  std::unique_ptr<FalconUsb> open();
  void initialise(std::unique_ptr<FalconUsb>& usb);
  void keepOpen(std::unique_ptr<FalconUsb> usb);
  void serve(FalconUsb& usb);
  void onData(std::span<const std::uint8_t> data);
  void watchLoop(FalconUsb& usb);
  void endWithZero(FalconUsb& usb);
  std::unique_ptr<FalconUsb> openAgain();

  FalconSettings settings_;
  const Clock& clock_;
  const LogLine log_line_;
  std::string serial_;
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
  std::thread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
