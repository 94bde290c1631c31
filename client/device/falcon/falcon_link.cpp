// SPDX-License-Identifier: MIT
#if HAPTICAST_LIBUSB
#include "client/device/falcon/falcon_link.hpp"

#include <fmt/core.h>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <utility>

#include "client/device/falcon/firmware.hpp"
#include "client/device/falcon/pilot.hpp"
#include "client/device/sleep_until.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;

// Chosen:
constexpr int kLoads = 6;  // in the field a load often needs several
constexpr milliseconds kTurn{10};
constexpr milliseconds kMute{1000};    // then the device counts as lost
constexpr milliseconds kHungLoop{20};  // then the motors receive zero
constexpr milliseconds kBetweenTries{500};
constexpr milliseconds kProbePatience{100};
constexpr milliseconds kBootPatience{1000};  // of the firmware after it was loaded
constexpr int kZeros = 4;
constexpr milliseconds kZeroAnswer{20};

const FalconRequest kNoTorque{.lights = FalconLight::kRed};

}  // namespace

FalconLink::FalconLink(FalconSettings settings, const Clock& clock, LogLine log_line)
    : settings_(std::move(settings)), clock_(clock), log_line_(std::move(log_line)) {
  if (settings_.firmware_file.empty()) settings_.firmware_file = usualFalconFirmware();
  if (!settings_.firmware_file.empty()) (void)readFalconFirmware(settings_.firmware_file);
  auto usb = open();
  serial_ = usb->serial();
  sem_init(&replied_, 0, 0);
  thread_ = std::thread([this, first = std::move(usb)]() mutable { keepOpen(std::move(first)); });
}

FalconLink::~FalconLink() {
  stop_ = true;
  thread_.join();
  sem_destroy(&replied_);
}

std::unique_ptr<FalconUsb> FalconLink::open() {
  auto usb = std::make_unique<FalconUsb>(settings_.serial);
  if (!falconRuns(*usb, settings_.event_character, kProbePatience)) initialise(usb);
  return usb;
}

/// Loads the firmware; each attempt reopens the device.
void FalconLink::initialise(std::unique_ptr<FalconUsb>& usb) {
  if (settings_.firmware_file.empty() && life_ > 0)
    throw FalconError(
        "it ran before and does not answer any more: check its cable and power supply. After a "
        "power-up it needs --falcon-firmware FILE");
  if (settings_.firmware_file.empty())
    throw FalconError(
        "its firmware is not loaded, as after every power-up: name the file with --falcon-firmware "
        "FILE");
  const auto image = readFalconFirmware(settings_.firmware_file);
  std::string trouble;
  for (int load = 1; load <= kLoads && !stop_; ++load) {
    if (load > 1) {
      log_line_(fmt::format("Falcon: {}; attempt {} of {}", trouble, load, kLoads));
      usb.reset();
      usb = std::make_unique<FalconUsb>(settings_.serial);
      // It may run by now: some firmware starts slowly.
      if (falconRuns(*usb, settings_.event_character, kProbePatience)) return;
    }
    log_line_(fmt::format("Falcon: loading its firmware ({} bytes)", image.size()));
    try {
      int logged_tenths = 0;
      loadFalconFirmware(*usb, image, [&](double share) {
        if (10.0 * share < logged_tenths + 5) return;
        logged_tenths += 5;
        log_line_(fmt::format("Falcon: {:.0f} % of its firmware is loaded", 100.0 * share));
      });
      if (falconRuns(*usb, settings_.event_character, kBootPatience)) return;
      trouble = "the device does not run with this firmware: is it the right file?";
    } catch (const FalconError& error) {
      trouble = error.what();
    }
  }
  throw FalconError(fmt::format("its firmware could not be loaded from {}: {}",
                                settings_.firmware_file, trouble));
}

void FalconLink::keepOpen(std::unique_ptr<FalconUsb> usb) {
  while (usb) {
    serve(*usb);
    usb.reset();
    if (stop_) return;
    log_line_("Falcon: the connection is lost; no force. The client reconnects automatically");
    usb = openAgain();
    if (usb) log_line_("Falcon: the connection is restored");
  }
}

/// Waits until the device answers again. Returns null at the end.
std::unique_ptr<FalconUsb> FalconLink::openAgain() {
  std::string logged;
  while (!stop_) {
    std::this_thread::sleep_for(kBetweenTries);
    try {
      return open();
    } catch (const std::runtime_error& error) {
      if (logged == error.what()) continue;
      logged = error.what();
      log_line_("Falcon: " + logged);
    }
  }
  return nullptr;
}

/// Runs the USB transfers from the first to the last.
void FalconLink::serve(FalconUsb& usb) {
  parser_.restart();
  ++life_;
  last_reply_ = clock_.now();
  torque_sent_ = false;
  bool good = true;
  try {
    usb.start([this](std::span<const std::uint8_t> data) { onData(data); });
  } catch (const FalconError&) {
    good = false;
  }
  if (good) {
    const std::lock_guard lock(usb_mutex_);
    usb_ = &usb;
    there_.store(true, std::memory_order_release);
  }
  while (good && !stop_) {
    good = usb.handleEvents(kTurn) && clock_.now() - last_reply_ < kMute;
    watchLoop(usb);
  }
  {
    const std::lock_guard lock(usb_mutex_);
    usb_ = nullptr;
    there_.store(false, std::memory_order_release);
  }
  endWithZero(usb);
  usb.finish();
}

void FalconLink::onData(std::span<const std::uint8_t> data) {
  const std::uint64_t before = parser_.resyncs();
  for (const std::uint8_t byte : data) {
    const auto reply = parser_.push(byte);
    if (!reply) continue;
    last_reply_ = clock_.now();
    round_trips_.fetch_add(1, std::memory_order_relaxed);
    // If the ring is full, the loop is late. It then needs only the newest of the later replies.
    (void)ring_.tryPush({*reply, last_reply_, life_});
    sem_post(&replied_);
  }
  resyncs_.fetch_add(parser_.resyncs() - before, std::memory_order_relaxed);
}

/// Watchdog: the device has no documented timeout of its own, so a hung loop must not leave a
/// torque on the motors.
void FalconLink::watchLoop(FalconUsb& usb) {
  const std::int64_t now_ns = clock_.now().time_since_epoch().count();
  if (now_ns - last_sent_ns_ < std::chrono::nanoseconds(kHungLoop).count()) return;
  const std::lock_guard lock(usb_mutex_);
  if (!torque_sent_) return;
  if (usb.submit(encode(kNoTorque), true)) torque_sent_ = false;
}

/// Sends zero several times and waits for the replies, because a request may be lost.
void FalconLink::endWithZero(FalconUsb& usb) {
  int answered = 0;
  for (int i = 0; i < 2 * kZeros && answered < kZeros; ++i) {
    const std::uint64_t before = round_trips_;
    if (!usb.submit(encode(kNoTorque), true) && !usb.handleEvents(milliseconds(1))) return;
    const LocalTime until = clock_.now() + kZeroAnswer;
    while (round_trips_ == before && clock_.now() < until) {
      if (!usb.handleEvents(milliseconds(1))) return;  // the device is lost
    }
    if (round_trips_ != before) ++answered;
  }
  if (answered == 0)
    log_line_("Falcon: the device does not confirm zero force at the end: switch its power off");
}

void FalconLink::send(const FalconRequest& request) noexcept {
  const std::unique_lock lock(usb_mutex_, std::try_to_lock);
  if (!lock || usb_ == nullptr) return;
  while (sem_trywait(&replied_) == 0) {  // late replies count with the next one
  }
  const bool zero = request.motors == std::array<int, 3>{};
  // Set before the request: an end in between has to send zero.
  if (!zero) torque_sent_ = true;
  const bool sent = usb_->submit(encode(request), zero);
  if (zero && sent) torque_sent_ = false;
  last_sent_ns_ = clock_.now().time_since_epoch().count();
}

bool FalconLink::waitForReply(LocalTime deadline) noexcept {
  const timespec until = toTimespec(deadline);
  int result = 0;
  do {
    result = sem_clockwait(&replied_, CLOCK_MONOTONIC, &until);
  } while (result != 0 && errno == EINTR);
  if (result != 0) misses_.fetch_add(1, std::memory_order_relaxed);
  return result == 0;
}

DeviceTraffic FalconLink::traffic() const noexcept {
  return {.round_trips = round_trips_, .misses = misses_, .resyncs = resyncs_};
}

bool FalconLink::sendZero() noexcept {
  const std::lock_guard lock(usb_mutex_);
  if (usb_ == nullptr || !usb_->submit(encode(kNoTorque), true)) return false;
  torque_sent_ = false;
  return true;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_LIBUSB
