// SPDX-License-Identifier: MIT
// The page of memory that the client shares with the helper process of its device. In each tick the
// client's loop writes a command, and the helper's loop writes a reading. Each direction has a
// sequence lock with the newest value, and a futex that wakes the other side. The command is also
// the heartbeat of the client.
// Thread: the loop of each process.
#pragma once

#include <atomic>
#include <cstdint>

#include "client/device/hapticast_device.h"
#include "common/sync/seq_lock.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Command of the client: the force of one tick.
struct DeviceCommand {
  double force_N[3] = {};
  std::int64_t time_ns = 0;   ///< local time of the command; 0: none yet
  std::uint64_t reading = 0;  ///< number of the reading that led to the force
  std::uint32_t warns = 0;    ///< 1: the device shows a safety state to the user
  std::uint32_t reserved = 0;
};

/// Reading of the helper: the driver's state in one tick.
struct DeviceReading {
  std::uint64_t number = 0;  ///< 1, 2, ...; 0: none yet
  hapticast_state state = {};
  /// Time from the measurement of a position until the driver received the force for it; 0: not
  /// measured yet.
  std::int64_t delay_ns = 0;
  std::uint64_t reduced = 0;  ///< ticks in which the helper reduced the commanded force
  std::uint64_t slow = 0;     ///< calls of exchange() that lasted more than 0.5 ms
};

/// A counter in shared memory that a thread of the other process can wait for.
class Doorbell {
 public:
  /// Returns the number of rings so far.
  [[nodiscard]] std::uint32_t rings() const noexcept {
    return rings_.load(std::memory_order_acquire);
  }
  /// Increments the counter and wakes the other side. One system call.
  void ring() noexcept;
  /// Waits until the counter differs from `seen`, at most until `deadline`.
  void wait(std::uint32_t seen, LocalTime deadline) const noexcept;

 private:
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  std::atomic<std::uint32_t> rings_{0};
};

/// Layout of the page. Client and helper are of one build, so the layout needs no version.
struct SharedPage {
  SeqLock<DeviceCommand> command;
  Doorbell commanded;
  SeqLock<DeviceReading> reading;
  Doorbell read;
};

/// Owner of a SharedPage. The page is in anonymous shared memory, so another process needs its file
/// descriptor to map it.
class PageMapping {
 public:
  /// Creates a page. Throws std::system_error.
  PageMapping();
  /// Maps the page of `file_descriptor`, and closes the file descriptor. Throws std::system_error.
  explicit PageMapping(int file_descriptor);
  ~PageMapping();
  PageMapping(const PageMapping&) = delete;
  PageMapping& operator=(const PageMapping&) = delete;

  [[nodiscard]] SharedPage& page() const noexcept { return *page_; }
  /// Returns the file descriptor of a created page. exec() closes it.
  [[nodiscard]] int fileDescriptor() const noexcept { return file_descriptor_; }

 private:
  void map();

  int file_descriptor_ = -1;
  SharedPage* page_ = nullptr;
};

}  // namespace hapticast::client
