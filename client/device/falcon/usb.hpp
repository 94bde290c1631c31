// SPDX-License-Identifier: MIT
// A Novint Falcon on USB: found, opened, claimed, its serial chip set up, bytes to and from it. The
// one place that knows libusb.
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

/// The Falcon is not there, not ours or does not answer; one line without the flag.
class FalconError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct FalconFound {
  std::string serial;   ///< empty: it cannot be read
  std::string problem;  ///< why it cannot be opened; empty: it can
};
/// All that are plugged in. Throws FalconError where USB cannot be asked.
std::vector<FalconFound> findFalcons();

/// Not thread-safe but for submit(); what belongs to which thread is said.
class FalconUsb {
 public:
  using OnData = std::function<void(std::span<const std::uint8_t> data)>;

  /// Opens and claims the first one, or that of `serial`. Throws FalconError.
  explicit FalconUsb(const std::string& serial);
  ~FalconUsb();
  FalconUsb(const FalconUsb&) = delete;
  FalconUsb& operator=(const FalconUsb&) = delete;

  // Before start(); they block and throw FalconError.
  /// A request to the serial chip.
  void control(std::uint8_t request, std::uint16_t value);
  void write(std::span<const std::uint8_t> bytes);
  /// Appends what one packet brings; false: none came in time.
  bool read(std::vector<std::uint8_t>& bytes, Duration most);

  /// From now on transfers are always queued; `on_data` gets the bytes. Throws FalconError.
  void start(OnData on_data);
  /// Handles what has come, waiting `most` for it; false: the device is gone or only fails. Thread:
  /// one, which `on_data` is called on.
  bool handleEvents(Duration most);
  /// Sends a frame without waiting for it. While the device takes none, a few are queued; an
  /// `urgent` one has places of its own. Thread: one; not while finish() runs.
  bool submit(const FalconFrame& frame, bool urgent) noexcept;
  /// Takes back what is queued. Thread: that of handleEvents().
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
  int failures_ = 0;  // in a row
};

}  // namespace hapticast::client
