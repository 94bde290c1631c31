// SPDX-License-Identifier: MIT
#include "client/device/helper/helper_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "client/device/helper/driver_profile.hpp"
#include "client/device/helper/helper_process.hpp"
#include "client/device/helper/state_check.hpp"
#include "client/device/sleep_until.hpp"
#include "client/haptics/safety/wall_law.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/rate_limiter.hpp"
#include "common/sync/seq_lock.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;
using Kind = HelperMessage::Kind;

constexpr Duration kTurn = milliseconds(20);  // stop() is noticed so late
constexpr auto kListPatience = std::chrono::seconds(2);
constexpr int kMostRestarts = 3;
constexpr int kDelayTicksMeasured = 200;
// Chosen: a start logs less, and a user reads no more.
constexpr int kMostLines = 20;
constexpr Duration kLineRefill = milliseconds(500);

/// One run of the helper, with a page of its own: a helper may die while it writes.
struct Life {
  PageMapping mapping;
  std::optional<HelperProcess> process;
  std::uint32_t seen = 0;  // loop
};

class HelperDevice final : public HapticDevice {
 public:
  explicit HelperDevice(const DeviceRequest& request);
  ~HelperDevice() override;

  const DeviceProfile& profile() const noexcept override { return profile_; }
  std::string description() const override {
    return fmt::format("{} ({}{}{}) in a process of its own", name_, profile_.name,
                       serial_.empty() ? "" : ", serial number ", serial_);
  }
  std::string id() const override { return serial_.empty() ? name_ : name_ + " " + serial_; }
  void waitForTick(LocalTime deadline) noexcept override;
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept override;
  void sendForceEarly(const Vec3& force_N) noexcept override;
  std::optional<std::string> nextMessage() override;
  std::optional<DeviceTraffic> traffic() const noexcept override;

 private:
  std::unique_ptr<Life> start(hapticast_profile& profile,
                              const std::function<void(const std::string&)>& log_line);
  void measureDelay();
  void watch();
  void restart();
  void pushMessage(const std::string& line);
  void storeCommand(Life& life, const Vec3& force_N) noexcept;

  const std::string name_;
  const Clock& clock_;
  const std::string program_;
  const std::map<std::string, std::string> options_;
  PlantProfile profile_;
  std::string serial_;
  std::vector<std::unique_ptr<Life>> lives_;  // all remain mapped for the loop
  std::atomic<Life*> life_{nullptr};          // null: no helper runs
  std::atomic<bool> stop_{false};
  // Loop:
  Life* last_life_ = nullptr;
  DeviceReading reading_;
  bool warns_ = false;
  std::optional<StateCheck> check_;
  // The thread of this object:
  RateLimiter driver_lines_{kMostLines, kLineRefill};
  // Main:
  std::array<bool, StateCheck::kFindings> reported_{};
  bool slow_reported_ = false;
  // Any:
  SeqLock<DeviceTraffic> traffic_;
  std::mutex messages_mutex_;
  std::deque<std::string> messages_;
  std::thread thread_;  // last member: the thread uses all members above
};

HelperDevice::HelperDevice(const DeviceRequest& request)
    : name_(request.kind),
      clock_(request.clock),
      program_(request.helper_program.empty() ? findHelperProgram() : request.helper_program),
      options_(selectDriverOptions(request.options, request.kind)) {
  hapticast_profile driver = unknownProfile();
  lives_.push_back(start(driver, request.log));
  profile_ = convertProfile(name_, driver, request.profile);
  serial_ = sanitizeUtf8(driver.serial);
  check_.emplace(profile_.workspace_mm);
  life_ = lives_.back().get();
  measureDelay();
  thread_ = std::thread([this] { watch(); });
}

HelperDevice::~HelperDevice() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  lives_.back()->process.reset();
}

/// Starts a helper and waits until the device is open. Returns null if stop_ became true.
std::unique_ptr<Life> HelperDevice::start(hapticast_profile& profile,
                                          const std::function<void(const std::string&)>& log_line) {
  auto life = std::make_unique<Life>();
  life->process.emplace(program_, name_, "open", options_, &life->mapping);
  while (!stop_) {
    const Received received = life->process->receive(clock_.now() + kTurn);
    if (received.ended) {
      throw DeviceAbsent(fmt::format("--device {}: its driver ended while it opened the device: {}",
                                     name_, life->process->end()));
    }
    if (!received.message) continue;
    const HelperMessage& message = *received.message;
    if (message.kind == Kind::kLog) log_line(message.text);
    if (message.kind == Kind::kAbsent)
      throw DeviceAbsent(fmt::format("--device {}: {}", name_, message.text));
    if (message.kind == Kind::kRefused)
      throw std::runtime_error(message.text.starts_with("--")
                                   ? message.text
                                   : fmt::format("--device {}: {}", name_, message.text));
    if (message.kind == Kind::kOpened) {
      profile = message.profile;
      return life;
    }
  }
  return nullptr;
}

/// Measures the delay from a position to its force with forces of zero. A larger delay than that of
/// the profile overrules it: a delay must never be understated.
void HelperDevice::measureDelay() {
  std::vector<std::int64_t> delays_ns;
  LocalTime deadline = clock_.now();
  for (int i = 0; i < kDelayTicksMeasured; ++i) {
    deadline = std::max(deadline + kTickPeriod, clock_.now());
    waitForTick(deadline);
    if (exchange(Vec3::Zero(), {}).status == DeviceStatus::kOk && reading_.delay_ns > 0)
      delays_ns.push_back(reading_.delay_ns);
    sendForceEarly(Vec3::Zero());
  }
  if (delays_ns.empty()) return;
  const auto middle = delays_ns.begin() + static_cast<std::ptrdiff_t>(delays_ns.size() / 2);
  std::nth_element(delays_ns.begin(), middle, delays_ns.end());
  const double median_ms = 1e-6 * static_cast<double>(*middle);
  const int measured_ticks = static_cast<int>(std::ceil(median_ms - 0.5));
  if (measured_ticks <= profile_.delay_ticks) return;
  if (measured_ticks > kMostDelay_ticks)
    throw DeviceAbsent(fmt::format(
        "--device {}: {:.1f} ms pass from a position to its force; at most {} ms are stable", name_,
        median_ms, kMostDelay_ticks));
  pushMessage(
      fmt::format("{}: {:.1f} ms pass from a position to its force, not {} ms as its driver "
                  "says: walls are softer",
                  name_, median_ms, profile_.delay_ticks));
  profile_.delay_ticks = measured_ticks;
}

void HelperDevice::storeCommand(Life& life, const Vec3& force_N) noexcept {
  DeviceCommand command;
  std::copy_n(force_N.data(), 3, command.force_N);
  command.time_ns = clock_.now().time_since_epoch().count();
  command.reading = reading_.number;
  command.warns = warns_ ? 1 : 0;
  life.mapping.page().command.store(command);
}

void HelperDevice::waitForTick(LocalTime deadline) noexcept {
  Life* const life = life_.load(std::memory_order_acquire);
  if (life == nullptr) {
    sleepUntil(deadline);
    return;
  }
  const Doorbell& read = life->mapping.page().read;
  read.wait(life->seen, deadline);
  life->seen = read.rings();
}

DeviceState HelperDevice::exchange(const Vec3& force_N, const TickReport& report) noexcept {
  warns_ = report.safety_states != 0;
  Life* const life = life_.load(std::memory_order_acquire);
  if (std::exchange(last_life_, life) != life) {
    check_->restart();
    reading_ = {};
  }
  const LocalTime now = clock_.now();
  if (life == nullptr) {
    DeviceState lost = check_->check({}, now);
    lost.status = DeviceStatus::kLost;
    return lost;
  }
  storeCommand(*life, force_N);
  (void)life->mapping.page().reading.load(reading_);
  traffic_.store({.round_trips = reading_.state.replies,
                  .misses = reading_.state.misses,
                  .resyncs = reading_.state.damaged,
                  .saturated = reading_.state.saturated,
                  .reduced = reading_.reduced,
                  .slow = reading_.slow});
  return check_->check(reading_, now);
}

void HelperDevice::sendForceEarly(const Vec3& force_N) noexcept {
  Life* const life = life_.load(std::memory_order_acquire);
  if (life == nullptr || life != last_life_) return;
  storeCommand(*life, force_N);
  life->mapping.page().commanded.ring();
}

std::optional<DeviceTraffic> HelperDevice::traffic() const noexcept {
  DeviceTraffic traffic;
  (void)traffic_.load(traffic);
  return traffic;
}

/// Waits for messages and for the end of the helper.
void HelperDevice::watch() {
  while (!stop_) {
    const Received received = lives_.back()->process->receive(clock_.now() + kTurn);
    if (received.message && received.message->kind == Kind::kLog) {
      if (const auto line = driver_lines_.admit(received.message->text, clock_.now()))
        pushMessage(*line);
    }
    if (received.ended) restart();
  }
}

/// Starts another helper after the end of one. It commands zero as soon as the device is open.
void HelperDevice::restart() {
  life_.store(nullptr, std::memory_order_release);
  pushMessage(
      fmt::format("{}: its driver ended ({}); no force", name_, lives_.back()->process->end()));
  while (!stop_) {
    if (lives_.size() > kMostRestarts) {
      pushMessage(fmt::format("{}: its driver ended {} times; start the client again", name_,
                              lives_.size()));
      while (!stop_) std::this_thread::sleep_for(kTurn);
      return;
    }
    try {
      hapticast_profile profile = unknownProfile();
      auto life = start(profile, [this](const std::string& line) { pushMessage(line); });
      if (!life) return;
      lives_.push_back(std::move(life));
      life_.store(lives_.back().get(), std::memory_order_release);
      pushMessage(name_ + ": its driver runs again, the device is at zero force");
      return;
    } catch (const std::runtime_error& error) {
      lives_.push_back(std::make_unique<Life>());
      pushMessage(error.what());
    }
  }
}

void HelperDevice::pushMessage(const std::string& line) {
  const std::lock_guard lock(messages_mutex_);
  messages_.push_back(line);
}

std::optional<std::string> HelperDevice::nextMessage() {
  {
    const std::lock_guard lock(messages_mutex_);
    if (!messages_.empty()) {
      std::string line = std::move(messages_.front());
      messages_.pop_front();
      return line;
    }
  }
  for (std::size_t i = 0; i < reported_.size(); ++i) {
    const auto finding = static_cast<StateCheck::Finding>(i);
    if (check_->count(finding) == 0 || std::exchange(reported_[i], true)) continue;
    return fmt::format("{}: its driver reported {}; the client ignores such readings", name_,
                       toText(finding));
  }
  const auto counters = traffic();
  if (counters->slow == 0 || std::exchange(slow_reported_, true)) return std::nullopt;
  return fmt::format(
      "{}: an exchange of its driver lasted more than 0.5 ms (the summary has the "
      "number of them)",
      name_);
}

}  // namespace

std::unique_ptr<HapticDevice> openHelperDevice(const DeviceRequest& request) {
  return std::make_unique<HelperDevice>(request);
}

std::vector<std::string> listHelperDevices(const DeviceRequest& request) {
  HelperProcess process(
      request.helper_program.empty() ? findHelperProgram() : request.helper_program, request.kind,
      "list", selectDriverOptions(request.options, request.kind), nullptr);
  const LocalTime until = request.clock.now() + kListPatience;
  std::vector<std::string> lines;
  while (request.clock.now() < until) {
    const Received received = process.receive(until);
    if (received.ended)
      throw std::runtime_error("its driver ended while it searched: " + process.end());
    if (!received.message) continue;
    const HelperMessage& message = *received.message;
    if (message.kind == Kind::kListed) return lines;
    if (message.kind == Kind::kRefused) throw std::runtime_error(message.text);
    if (message.kind != Kind::kFound) continue;
    lines.push_back(message.problem.empty() ? "serial number " + message.text
                                            : "found, but " + message.problem);
  }
  throw std::runtime_error("its driver did not answer within two seconds");
}

}  // namespace hapticast::client
