// SPDX-License-Identifier: MIT
// USB transport of the Novint Falcon: find, open, claim, set up the serial chip, transfer bytes.
// The only user of libusb.
// Thread: each function states its own.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/device/falcon/protocol.hpp"
#include "common/time.hpp"

struct libusb_context;
struct libusb_device;
struct libusb_device_handle;
struct libusb_transfer;

namespace hapticast::client {

/// The Falcon is missing, in use or silent. The message is one line without the flag.
class FalconError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A detected Falcon.
struct FalconFound {
  std::string serial;   ///< empty: unreadable
  std::string problem;  ///< reason why it cannot be opened; empty: it can
};
/// Returns all connected Falcons. Throws FalconError if USB is not accessible.
std::vector<FalconFound> findFalcons();

/// The connection. Only submit() is thread-safe; the other functions state their thread.
class FalconUsb {
 public:
  using OnData = std::function<void(std::span<const std::uint8_t> data)>;

  /// Opens and claims the first device, or the one with `serial`. Throws FalconError.
  explicit FalconUsb(const std::string& serial);
  ~FalconUsb();
  FalconUsb(const FalconUsb&) = delete;
  FalconUsb& operator=(const FalconUsb&) = delete;

  // Before start(): these functions block and throw FalconError.

  /// Sends a control request to the serial chip.
  void control(std::uint8_t request, std::uint16_t value);
  void write(std::span<const std::uint8_t> bytes);
  /// Appends the data of one packet to `bytes`. Returns false after `most` without data.
  bool read(std::vector<std::uint8_t>& bytes, Duration most);

  /// Starts the continuous transfers; `take` receives the bytes. Throws FalconError.
  void start(OnData on_data);
  /// Handles completed transfers and waits at most `most` for them. Returns false if the device is
  /// lost, or after too many errors. Thread: one, which also calls `take`.
  bool handleEvents(Duration most);
  /// Queues a frame without waiting. Returns false if all slots are in use; an `urgent` frame has
  /// additional slots. Thread: one; not during finish().
  bool submit(const FalconFrame& frame, bool urgent) noexcept;
  /// Cancels all queued transfers. Thread: that of handleEvents().
  void finish() noexcept;

 private:
  static constexpr std::size_t kIncoming = 4;
  static constexpr std::size_t kUsualOutgoing = 4;
  static constexpr std::size_t kOutgoing = 12;
  struct Transfer {
    FalconUsb* owner = nullptr;
    libusb_transfer* usb = nullptr;
    std::array<std::uint8_t, 64> buffer{};
    std::atomic<bool> queued{false};
    bool stalled = false;
    bool incoming = false;
  };

  void claim(const std::string& serial);
  void prepare(Transfer& transfer, bool incoming);
  bool queue(Transfer& transfer) noexcept;
  void completed(Transfer& transfer);
  void clearStalls();
  void release() noexcept;

  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  OnData on_data_;
  std::array<Transfer, kIncoming> incoming_;
  std::array<Transfer, kOutgoing> outgoing_;
  std::atomic<bool> disconnected_{false};
  bool finishing_ = false;
  int failures_ = 0;  // errors in a row
};

}  // namespace hapticast::client
