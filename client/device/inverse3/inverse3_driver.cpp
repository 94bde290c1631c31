// SPDX-License-Identifier: MIT
#include "client/device/inverse3/inverse3_driver.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "client/device/helper/program/make_driver.hpp"
#include "client/device/inverse3/protocol.hpp"
#include "client/device/inverse3/websocket.hpp"
#include "client/device/sleep_until.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;

constexpr Duration kFirstMessage = milliseconds(1000);
constexpr Duration kSilence = milliseconds(100);  // then the device counts as lost
constexpr Duration kReconnect = milliseconds(500);
// Chosen: half a tick. Measured on loopback: a median of 0.3 ms.
constexpr Duration kReplyPatience = std::chrono::microseconds(500);
// From the manufacturer's pages: the radius of the workspace. A cube fits into the ball.
constexpr double kInverse3Side_mm = 115.0;  // 2 * 100 / sqrt(3)
constexpr double kMinverseSide_mm = 46.0;   // 2 * 40 / sqrt(3)
constexpr double kPeak_N = 3.3;             // chosen: other programs clip at 2 N

/// Options of the driver.
struct Inverse3Settings {
  std::string host = "localhost";
  std::string port = "10001";
  std::string preset = "arm_front_centered";
  std::string force_key;  ///< empty: by the version of the service
  std::string id;         ///< empty: the first device
};

Inverse3Settings readInverse3Settings(const hapticast_host& host, const char* id) {
  Inverse3Settings settings;
  const auto read = [&host](const char* key, std::string& to) {
    if (const char* const value = host.option(host.self, key)) to = value;
  };
  std::string service;
  read("service", service);
  if (const std::size_t split = service.rfind(':'); split != std::string::npos) {
    settings.host = service.substr(0, split);
    settings.port = service.substr(split + 1);
  } else if (!service.empty()) {
    settings.host = service;
  }
  read("preset", settings.preset);
  read("force_key", settings.force_key);
  if (!settings.force_key.empty() && settings.force_key != "vector" &&
      settings.force_key != "values")
    throw std::runtime_error("--device-option force_key=" + settings.force_key +
                             ": is not vector or values");
  if (id != nullptr) settings.id = id;
  return settings;
}

/// Connects and receives the inventory, the first message of the service.
std::unique_ptr<WebSocket> connect(const Inverse3Settings& settings, Inverse3Message& inventory) {
  std::unique_ptr<WebSocket> socket;
  const std::string where = settings.host + ":" + settings.port;
  try {
    socket = std::make_unique<WebSocket>(settings.host, settings.port);
    const SteadyClock clock;
    const auto text = socket->receive(clock.now() + kFirstMessage);
    if (!text) throw std::runtime_error("its first message did not arrive");
    const auto message = parseInverse3(*text);
    if (!message) throw std::runtime_error("another service answers");
    inventory = *message;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the Inverse service does not answer at " + where + " (" +
                             error.what() +
                             "): start it, or name it with --device-option "
                             "service=HOST:PORT");
  }
  return socket;
}

/// An opened device. The loop's thread calls wait() and exchange().
class Inverse3 {
 public:
  Inverse3(const hapticast_host& host, const char* id, hapticast_profile& profile)
      : settings_(readInverse3Settings(host, id)), host_(host) {
    open();
    describe(profile);
  }

  static void list(const hapticast_host& host, const FoundDevice& found) {
    Inverse3Message inventory;
    (void)connect(readInverse3Settings(host, nullptr), inventory);
    for (const Inverse3Device& each : inventory.devices) found(each.id, "");
  }

  void wait(LocalTime deadline) {
    if (!socket_) {
      sleepUntil(deadline);
      reopen();
      return;
    }
    waitForGrid(deadline);
    try {
      if (!awaited_) {
        const Vec3 force_N = zero_.exchange(false) ? Vec3(Vec3::Zero()) : force_N_;
        socket_->send(toForceMessage(device_.id, key_, force_N));
        awaited_ = true;
      }
      if (const auto text = socket_->receive(due_ + kReplyPatience)) onMessage(*text);
      if (clock_.now() - answered_ > kSilence) throw std::runtime_error("it is silent");
    } catch (const std::runtime_error& error) {
      host_.log(
          host_.self,
          ("inverse3: the service is lost (" + std::string(error.what()) + "); no force").c_str());
      socket_.reset();
    }
  }

  void exchange(const Vec3& force_N, hapticast_state& state) {
    force_N_ = force_N;
    state.status = !socket_ || reading_ == Reading::kNoDevice ? HAPTICAST_LOST
                   : reading_ == Reading::kNew                ? HAPTICAST_OK
                                                              : HAPTICAST_NO_DATA;
    if (socket_ && !device_.calibrated) state.status = HAPTICAST_NO_DATA;
    if (reading_ == Reading::kNew) reading_ = Reading::kOld;
    if (device_.position_mm) std::copy_n(device_.position_mm->data(), 3, state.position_mm);
    state.buttons = buttons_;
    state.taken_ns = answered_.time_since_epoch().count();
    state.replies = replies_;
    state.damaged = damaged_;
  }

  /// The service forgets a force by itself. The next message commands zero. Thread: any.
  bool commandZero() {
    zero_ = true;
    return true;
  }

 private:
  void describe(hapticast_profile& profile) const {
    // A force goes out with the next message and acts in the service's next tick. The service's
    // filters delay it further.
    profile.delay_ticks = device_.filtered ? 3 : 2;
    if (device_.filtered)
      host_.log(host_.self,
                "inverse3: the service filters forces; switch its force gate and damping off for "
                "harder walls");
    profile.peak_N = kPeak_N;
    std::fill_n(profile.workspace_mm, 3,
                device_.type == "minverse" ? kMinverseSide_mm : kInverse3Side_mm);
    profile.rearm_button = 0;
    profile.pause_button = 1;
    profile.watchdog_ms = 20;
    copyText(device_.id, profile.serial, sizeof profile.serial);
  }

  /// Waits for the next deadline on a grid of 1 ms. Skips deadlines that a stall has missed.
  void waitForGrid(LocalTime deadline) {
    due_ = std::max(due_ + kTickPeriod, clock_.now());
    due_ = std::min(due_, std::max(deadline, clock_.now()));
    sleepUntil(due_);
  }

  void open() {
    Inverse3Message inventory;
    socket_ = connect(settings_, inventory);
    const auto wanted = std::find_if(inventory.devices.begin(), inventory.devices.end(),
                                     [this](const Inverse3Device& each) {
                                       return settings_.id.empty() || each.id == settings_.id;
                                     });
    if (wanted == inventory.devices.end())
      throw std::runtime_error(settings_.id.empty()
                                   ? "the Inverse service has no device: is it plugged in?"
                                   : "the Inverse service has no device " + quote(settings_.id));
    device_ = *wanted;
    reading_ = Reading::kOld;
    key_ = settings_.force_key.empty()       ? selectForceKey(inventory)
           : settings_.force_key == "vector" ? Inverse3ForceKey::kVector
                                             : Inverse3ForceKey::kValues;
    socket_->send(toSessionMessage(device_.id, settings_.preset));
    awaited_ = true;
    answered_ = clock_.now();
    if (!device_.calibrated)
      host_.log(host_.self, "inverse3: the device is not calibrated; follow the service's lights");
  }

  void reopen() {
    const LocalTime now = clock_.now();
    if (now - tried_ < kReconnect) return;
    tried_ = now;
    try {
      open();
      host_.log(host_.self, "inverse3: the service answers again");
    } catch (const std::runtime_error&) {
      socket_.reset();
    }
  }

  void onMessage(const std::string& text) {
    const auto message = parseInverse3(text);
    const auto device = !message ? nullptr : findDevice(*message);
    awaited_ = false;
    answered_ = clock_.now();
    ++replies_;
    if (!message || (device != nullptr && !device->position_mm)) {
      ++damaged_;
      return;
    }
    reading_ = device != nullptr ? Reading::kNew : Reading::kNoDevice;
    if (device == nullptr) return;
    device_.position_mm = device->position_mm;
    device_.calibrated = device->calibrated;
    buttons_ = message->buttons;
  }

  const Inverse3Device* findDevice(const Inverse3Message& message) const {
    const auto found =
        std::find_if(message.devices.begin(), message.devices.end(),
                     [this](const Inverse3Device& each) { return each.id == device_.id; });
    return found == message.devices.end() ? nullptr : &*found;
  }

  /// The newest reading. kNoDevice: the service does not have the device any more.
  enum class Reading : std::uint8_t { kNoDevice, kOld, kNew };

  const SteadyClock clock_;
  const Inverse3Settings settings_;
  const hapticast_host host_;
  std::unique_ptr<WebSocket> socket_;  // null: the service is lost
  Inverse3Device device_;
  Inverse3ForceKey key_ = Inverse3ForceKey::kVector;
  Vec3 force_N_ = Vec3::Zero();
  std::atomic<bool> zero_{false};
  bool awaited_ = false;  // a message is not answered yet
  Reading reading_ = Reading::kNoDevice;
  LocalTime due_{};  // time of the last message
  LocalTime answered_{};
  LocalTime tried_{};
  std::uint32_t buttons_ = 0;
  std::uint64_t replies_ = 0;
  std::uint64_t damaged_ = 0;
};

}  // namespace

const hapticast_driver* inverse3Driver() {
  static const hapticast_driver kDriver = makeDriver<Inverse3>(
      "inverse3", "a Haply Inverse3 or Minverse, through its service", HAPTICAST_NEEDS_NETWORK);
  return &kDriver;
}

}  // namespace hapticast::client
