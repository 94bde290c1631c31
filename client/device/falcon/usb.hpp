// SPDX-License-Identifier: MIT
// USB access to the Novint Falcon: find the device, open it, set up its serial chip, and transfer
// bytes. Only this class uses libusb.
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

/// Error of the USB access: the Falcon is missing, another program uses it, or it does not answer.
/// The message is one line. It does not name the flag of the command line.
class FalconError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A detected Falcon.
struct FalconFound {
  std::string serial;   ///< serial number; empty if it cannot be read
  std::string problem;  ///< reason why the device cannot be opened; empty if it can
};
/// Returns all connected Falcons. Throws FalconError if USB is not accessible.
std::vector<FalconFound> findFalcons();

/// An open Falcon. Each function states its thread.
class FalconUsb {
 public:
  using OnData = std::function<void(std::span<const std::uint8_t> data)>;

  /// Opens the device with the serial number `serial`, or the first device if `serial` is empty.
  /// Claims its USB interface, so that no other program can use it. Throws FalconError.
  explicit FalconUsb(const std::string& serial);
  ~FalconUsb();
  FalconUsb(const FalconUsb&) = delete;
  FalconUsb& operator=(const FalconUsb&) = delete;

  /// Returns the serial number of the device.
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }

  // Before start(): these functions block and throw FalconError.

  /// Sends a control request to the serial chip.
  void control(std::uint8_t request, std::uint16_t value);
  void write(std::span<const std::uint8_t> bytes);
  /// Reads one packet and appends its data to `bytes`. Returns false if no data arrives within
  /// `most`.
  bool read(std::vector<std::uint8_t>& bytes, Duration most);

  /// Starts continuous transfers. From then on `on_data` receives the bytes that arrive. Throws
  /// FalconError.
  void start(OnData on_data);
  /// Processes completed transfers, and calls `on_data` for their bytes. Waits at most `most` for a
  /// transfer. Returns false if the device is lost, or after too many errors. Thread: one, always
  /// the same.
  bool handleEvents(Duration most);
  /// Queues a frame for the transfer, without waiting. Returns false if all slots are in use. If
  /// `urgent` is true, the frame may use additional slots. Thread: one; not during finish().
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
  void onCompleted(Transfer& transfer);
  void clearStalls();
  void release() noexcept;

  libusb_context* context_ = nullptr;
  std::string serial_;
  libusb_device_handle* handle_ = nullptr;
  OnData on_data_;
  std::array<Transfer, kIncoming> incoming_;
  std::array<Transfer, kOutgoing> outgoing_;
  std::atomic<bool> disconnected_{false};
  bool finishing_ = false;
  int failures_ = 0;  // errors in a row
};

}  // namespace hapticast::client
