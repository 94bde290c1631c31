// SPDX-License-Identifier: MIT
#if HAPTICAST_LIBUSB
#include "client/device/falcon/usb.hpp"

#include <libusb.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint16_t kVendor = 0x0403;
constexpr std::uint16_t kProduct = 0xCB48;
constexpr std::uint8_t kIn = 0x81;
constexpr std::uint8_t kOut = 0x02;
constexpr int kInterface = 0;
constexpr int kStatusBytes = 2;  // before the data of every received packet: modem and line status
constexpr unsigned kTimeout_ms = 1000;
// Chosen: more errors in a row are no disturbance.
constexpr int kMostFailures = 50;

[[noreturn]] void fail(const std::string& what, int code) {
  throw FalconError(what + ": " + libusb_strerror(code));
}

/// Returns the reason why a connected device cannot be opened, and a remedy.
std::string errorText(int code) {
  if (code == LIBUSB_ERROR_ACCESS)
    return "no permission to open it: copy deploy/70-hapticast-falcon.rules to "
           "/etc/udev/rules.d and plug it in again";
  if (code == LIBUSB_ERROR_BUSY) return "another program uses the device: end that program first";
  return libusb_strerror(code);
}

struct ContextEnd {
  void operator()(libusb_context* context) const noexcept { libusb_exit(context); }
};
struct HandleEnd {
  void operator()(libusb_device_handle* handle) const noexcept { libusb_close(handle); }
};
struct ListEnd {
  void operator()(libusb_device** list) const noexcept { libusb_free_device_list(list, 1); }
};
using Handle = std::unique_ptr<libusb_device_handle, HandleEnd>;

libusb_context* newContext() {
  libusb_context* context = nullptr;
  const int code = libusb_init(&context);
  if (code != LIBUSB_SUCCESS) fail("USB cannot be used", code);
  return context;
}

bool isFalcon(libusb_device* device) {
  libusb_device_descriptor it{};
  return libusb_get_device_descriptor(device, &it) == LIBUSB_SUCCESS && it.idVendor == kVendor &&
         it.idProduct == kProduct;
}

std::string readSerial(libusb_device* device, libusb_device_handle* handle) {
  libusb_device_descriptor it{};
  std::array<unsigned char, 128> text{};
  if (libusb_get_device_descriptor(device, &it) != LIBUSB_SUCCESS) return "";
  const int length = libusb_get_string_descriptor_ascii(handle, it.iSerialNumber, text.data(),
                                                        static_cast<int>(text.size()));
  // The device is a stranger: its text may contain control characters.
  return length <= 0 ? ""
                     : sanitizeUtf8({reinterpret_cast<const char*>(text.data()),
                                     static_cast<std::size_t>(length)});
}

/// Calls visit(device, handle or null, result of the opening) for every Falcon until `visit`
/// returns true.
template <class Visit>
void forEachFalcon(libusb_context* context, Visit visit) {
  libusb_device** raw = nullptr;
  const auto count = libusb_get_device_list(context, &raw);
  if (count < 0) fail("USB cannot be used", static_cast<int>(count));
  const std::unique_ptr<libusb_device*, ListEnd> list(raw);
  for (libusb_device* device : std::span(raw, static_cast<std::size_t>(count))) {
    if (!isFalcon(device)) continue;
    libusb_device_handle* opened = nullptr;
    const int code = libusb_open(device, &opened);
    Handle handle(opened);
    if (visit(device, handle, code)) return;
  }
}

}  // namespace

std::vector<FalconFound> findFalcons() {
  const std::unique_ptr<libusb_context, ContextEnd> context(newContext());
  std::vector<FalconFound> found;
  forEachFalcon(context.get(), [&](libusb_device* device, const Handle& handle, int code) {
    if (code == LIBUSB_SUCCESS) {
      const int claimed = libusb_claim_interface(handle.get(), kInterface);
      found.push_back({readSerial(device, handle.get()),
                       claimed == LIBUSB_ERROR_BUSY ? errorText(claimed) : ""});
    } else {
      found.push_back({"", errorText(code)});
    }
    return false;
  });
  return found;
}

FalconUsb::FalconUsb(const std::string& serial) : context_(newContext()) {
  try {
    claim(serial);
    for (Transfer& transfer : incoming_) prepare(transfer, true);
    for (Transfer& transfer : outgoing_) prepare(transfer, false);
  } catch (...) {
    release();
    throw;
  }
}

FalconUsb::~FalconUsb() {
  finish();
  release();
}

void FalconUsb::release() noexcept {
  for (Transfer& transfer : incoming_) libusb_free_transfer(transfer.usb);
  for (Transfer& transfer : outgoing_) libusb_free_transfer(transfer.usb);
  if (handle_ != nullptr) {
    libusb_release_interface(handle_, kInterface);
    libusb_close(handle_);
  }
  libusb_exit(context_);
}

void FalconUsb::claim(const std::string& serial) {
  std::string problem = "none was found on USB: is it plugged in, and its power supply too?";
  forEachFalcon(context_, [&](libusb_device* device, Handle& handle, int code) {
    if (code != LIBUSB_SUCCESS) {
      problem = errorText(code);
      return false;
    }
    const std::string its = readSerial(device, handle.get());
    if (!serial.empty() && its != serial) {
      problem = "the connected device has the serial number " + its + ", not " + serial;
      return false;
    }
    libusb_set_auto_detach_kernel_driver(handle.get(), 1);
    const int claimed = libusb_claim_interface(handle.get(), kInterface);
    if (claimed != LIBUSB_SUCCESS) {
      problem = errorText(claimed);
      return false;
    }
    handle_ = handle.release();
    serial_ = its;
    return true;
  });
  if (handle_ == nullptr) throw FalconError(problem);
}

void FalconUsb::control(std::uint8_t request, std::uint16_t value) {
  constexpr std::uint8_t kVendorOut = 0x40;
  const int code =
      libusb_control_transfer(handle_, kVendorOut, request, value, 0, nullptr, 0, kTimeout_ms);
  if (code < 0) fail("its serial chip refuses a request", code);
}

void FalconUsb::write(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> own(bytes.begin(), bytes.end());  // libusb requires mutable bytes
  int written = 0;
  const int code = libusb_bulk_transfer(handle_, kOut, own.data(), static_cast<int>(own.size()),
                                        &written, kTimeout_ms);
  if (code != LIBUSB_SUCCESS) {
    libusb_clear_halt(handle_, kOut);
    fail("the device accepts no data", code);
  }
}

bool FalconUsb::read(std::vector<std::uint8_t>& bytes, Duration most) {
  std::array<std::uint8_t, 64> packet{};
  int length = 0;
  const auto timeout_ms = std::chrono::duration_cast<std::chrono::milliseconds>(most).count();
  const int code =
      libusb_bulk_transfer(handle_, kIn, packet.data(), static_cast<int>(packet.size()), &length,
                           static_cast<unsigned>(std::max<std::int64_t>(timeout_ms, 1)));
  if (code == LIBUSB_ERROR_PIPE) libusb_clear_halt(handle_, kIn);
  if (code != LIBUSB_SUCCESS && code != LIBUSB_ERROR_TIMEOUT)
    fail("the device cannot be read", code);
  if (length > kStatusBytes)
    bytes.insert(bytes.end(), packet.begin() + kStatusBytes, packet.begin() + length);
  return length > kStatusBytes;
}

void FalconUsb::prepare(Transfer& transfer, bool incoming) {
  transfer.owner = this;
  transfer.incoming = incoming;
  transfer.usb = libusb_alloc_transfer(0);
  if (transfer.usb == nullptr) fail("libusb cannot allocate a transfer", LIBUSB_ERROR_NO_MEM);
  const auto done = [](libusb_transfer* usb) {
    auto& its = *static_cast<Transfer*>(usb->user_data);
    its.owner->onCompleted(its);
  };
  const std::size_t length = incoming ? transfer.buffer.size() : FalconFrame{}.size();
  libusb_fill_bulk_transfer(transfer.usb, handle_, incoming ? kIn : kOut, transfer.buffer.data(),
                            static_cast<int>(length), done, &transfer, 0);
}

void FalconUsb::start(OnData on_data) {
  on_data_ = std::move(on_data);
  for (Transfer& transfer : incoming_) {
    if (!queue(transfer)) throw FalconError("the device was disconnected");
  }
}

bool FalconUsb::queue(Transfer& transfer) noexcept {
  transfer.queued.store(true, std::memory_order_relaxed);
  const int code = libusb_submit_transfer(transfer.usb);
  if (code == LIBUSB_SUCCESS) return true;
  transfer.queued.store(false, std::memory_order_relaxed);
  if (code == LIBUSB_ERROR_NO_DEVICE) disconnected_.store(true, std::memory_order_relaxed);
  return false;
}

void FalconUsb::onCompleted(Transfer& transfer) {
  const libusb_transfer& usb = *transfer.usb;
  const auto status = usb.status;
  if (status == LIBUSB_TRANSFER_COMPLETED) {
    failures_ = 0;
    if (transfer.incoming && usb.actual_length > kStatusBytes)
      on_data_(
          std::span(transfer.buffer)
              .subspan(kStatusBytes, static_cast<std::size_t>(usb.actual_length - kStatusBytes)));
  } else if (status != LIBUSB_TRANSFER_CANCELLED) {
    ++failures_;
  }
  if (status == LIBUSB_TRANSFER_NO_DEVICE) disconnected_.store(true, std::memory_order_relaxed);
  // No blocking call here, such as clearing a halt.
  transfer.stalled = status == LIBUSB_TRANSFER_STALL;
  transfer.queued.store(false, std::memory_order_release);
  const bool again = transfer.incoming && !transfer.stalled && !finishing_ && !disconnected_ &&
                     status != LIBUSB_TRANSFER_CANCELLED && failures_ < kMostFailures;
  if (again) (void)queue(transfer);
}

/// Clears halted endpoints and queues their transfers again.
void FalconUsb::clearStalls() {
  for (Transfer& transfer : incoming_) {
    if (!std::exchange(transfer.stalled, false)) continue;
    libusb_clear_halt(handle_, kIn);
    (void)queue(transfer);
  }
  const auto stalled = [](Transfer& transfer) { return std::exchange(transfer.stalled, false); };
  if (std::count_if(outgoing_.begin(), outgoing_.end(), stalled) > 0)
    libusb_clear_halt(handle_, kOut);
}

bool FalconUsb::handleEvents(Duration most) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(most).count();
  timeval time{static_cast<time_t>(us / 1'000'000), static_cast<suseconds_t>(us % 1'000'000)};
  const int code = libusb_handle_events_timeout_completed(context_, &time, nullptr);
  if (!finishing_ && !disconnected_) clearStalls();
  return (code == LIBUSB_SUCCESS || code == LIBUSB_ERROR_INTERRUPTED) && !disconnected_ &&
         failures_ < kMostFailures;
}

bool FalconUsb::submit(const FalconFrame& frame, bool urgent) noexcept {
  const auto places = std::span(outgoing_).first(urgent ? kOutgoing : kUsualOutgoing);
  for (Transfer& transfer : places) {
    if (transfer.queued.load(std::memory_order_acquire)) continue;
    std::copy(frame.begin(), frame.end(), transfer.buffer.begin());
    return queue(transfer);
  }
  return false;
}

void FalconUsb::finish() noexcept {
  finishing_ = true;
  const auto queued = [](const Transfer& transfer) { return transfer.queued.load(); };
  const auto any = [&] {
    return std::any_of(incoming_.begin(), incoming_.end(), queued) ||
           std::any_of(outgoing_.begin(), outgoing_.end(), queued);
  };
  for (Transfer& transfer : incoming_) {
    if (queued(transfer)) libusb_cancel_transfer(transfer.usb);
  }
  for (Transfer& transfer : outgoing_) {
    if (queued(transfer)) libusb_cancel_transfer(transfer.usb);
  }
  // The kernel returns every transfer at once.
  constexpr int kMostTurns = 200;
  for (int i = 0; i < kMostTurns && any(); ++i) {
    timeval time{0, 10'000};
    libusb_handle_events_timeout_completed(context_, &time, nullptr);
  }
}

}  // namespace hapticast::client

#endif  // HAPTICAST_LIBUSB
