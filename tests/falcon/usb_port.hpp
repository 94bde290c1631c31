// SPDX-License-Identifier: MIT
// A USB port of the emulated machine with a Falcon in it: answers what libusb asks the kernel, from
// this process and from its children. The preload library of umockdev brings the questions here.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/falcon/falcon_model.hpp"

typedef struct _UMockdevTestbed UMockdevTestbed;
typedef struct _UMockdevIoctlBase UMockdevIoctlBase;
typedef struct _UMockdevIoctlClient UMockdevIoctlClient;
typedef struct _UMockdevIoctlData UMockdevIoctlData;

namespace hapticast::testing {

/// The faults of the bus; changed under the port's lock.
struct BusFaults {
  bool busy = false;      ///< another program holds the interface
  bool stall_in = false;  ///< until the host clears it
  bool stall_out = false;
  int protocol_errors = 0;            ///< so many packets are damaged
  int babbles = 0;                    ///< so many are longer than allowed
  std::chrono::milliseconds hang{0};  ///< the next reap takes so long
};

/// Whether the preload library is there.
bool hasUmockdev();

class UsbPort {
 public:
  explicit UsbPort(std::vector<std::uint8_t> firmware, const std::string& serial = "FT0TEST1");
  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  void plugIn();
  void unplug();
  /// Nobody but root may open it from now on.
  void forbid();
  /// Calls `act(model, bus)` while nothing else happens.
  template <class Act>
  auto with(Act act) {
    const std::lock_guard lock(mutex_);
    const auto restore = [this] { changed_.notify_all(); };
    if constexpr (std::is_void_v<decltype(act(model_, bus_))>) {
      act(model_, bus_);
      restore();
    } else {
      auto result = act(model_, bus_);
      restore();
      return result;
    }
  }
  /// The file that stands for the device.
  [[nodiscard]] std::string node() const;

  /// Called by the preload library's side. Thread: its worker.
  bool answer(UMockdevIoctlClient* client);
  void vanished(UMockdevIoctlClient* client);

 private:
  struct Urb {
    UMockdevIoctlClient* client = nullptr;
    UMockdevIoctlData* urb = nullptr;
    UMockdevIoctlData* buffer = nullptr;
    bool done = false;
  };

  int submit(UMockdevIoctlClient* client, UMockdevIoctlData* data);
  int discard(UMockdevIoctlClient* client);
  int reap(UMockdevIoctlClient* client, UMockdevIoctlData* data);
  void control(Urb& urb);
  void finishUrb(Urb& urb, int status, int length);
  void giveIncoming(LocalTime now);
  bool failIncoming(Urb& urb);
  void run();
  void showReady();
  static void release(Urb& urb);
  LocalTime now() const { return clock_.now(); }

  SteadyClock clock_;
  std::mutex mutex_;
  std::condition_variable changed_;
  FalconModel model_;
  BusFaults bus_;
  std::string serial_;
  UMockdevTestbed* testbed_ = nullptr;
  UMockdevIoctlBase* handler_ = nullptr;
  int number_ = 4;  // of the device on the bus
  bool plugged_ = false;
  int pipe_ = -1;       // full: nothing to reap
  bool ready_ = false;  // it is empty
  std::deque<Urb> urbs_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace hapticast::testing
