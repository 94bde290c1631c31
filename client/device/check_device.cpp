// SPDX-License-Identifier: MIT
#include "client/device/check_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "client/haptics/tick_report.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr double kCheckPush_N = 0.3;
constexpr int kCheckPush_ticks = 100;
constexpr int kCheckRamp_ticks = 20;  // of the push, up and down
constexpr int kStill_ticks = 500;     // of a grip that is held still, before each push
constexpr double kStill_mm = 1.0;
constexpr int kCheckSettle_ticks = 100;  // the motion goes on for a while after the push
constexpr auto kStillPatience = std::chrono::seconds(60);
// 0.3 N for 0.1 s move a free grip of 50 to 500 g by 3 to 30 mm, and one in a loose hand by less.
constexpr double kLeastResponse_mm = 0.2;
constexpr double kMostResponse_mm = 40.0;
constexpr std::array<const char*, 3> kAxisNames{"x (right)", "y (up)", "z (towards you)"};

/// The check was stopped.
struct Stopped {};

/// Runs the ticks of the device.
class CheckRun {
 public:
  CheckRun(HapticDevice& device, const Clock& clock, const std::atomic<bool>& stop,
           const std::function<void(const std::string&)>& log_line)
      : device_(device), clock_(clock), stop_(stop), log_line_(log_line) {}
  ~CheckRun() { (void)device_.exchange(Vec3::Zero(), {}); }
  CheckRun(const CheckRun&) = delete;
  CheckRun& operator=(const CheckRun&) = delete;

  /// Waits until the grip is held still.
  void waitForRest() {
    const LocalTime until = clock_.now() + kStillPatience;
    int rest_ticks = 0;
    Vec3 begin_mm = Vec3::Zero();
    while (rest_ticks < kStill_ticks) {
      if (clock_.now() > until)
        throw std::runtime_error("--check-device: the grip was not held still for a minute");
      const bool fresh = tick(Vec3::Zero());
      if (!fresh) continue;
      if (rest_ticks++ == 0) begin_mm = position_mm_;
      if ((position_mm_ - begin_mm).norm() > kStill_mm) rest_ticks = 0;
    }
  }
  /// Pushes once. Returns the motion in mm.
  Vec3 push(const Vec3& force_N) {
    waitForRest();
    const Vec3 begin_mm = position_mm_;
    for (int i = 0; i < kCheckPush_ticks + kCheckSettle_ticks; ++i) {
      const double up = static_cast<double>(i) / kCheckRamp_ticks;
      const double down = static_cast<double>(kCheckPush_ticks - i) / kCheckRamp_ticks;
      (void)tick(std::clamp(std::min(up, down), 0.0, 1.0) * force_N);
    }
    return position_mm_ - begin_mm;
  }

 private:
  /// Returns true if the device has a new position.
  bool tick(const Vec3& force_N) {
    if (stop_) throw Stopped();
    device_.waitForTick(deadline_);
    deadline_ = clock_.now() + kTickPeriod;
    const DeviceState state = device_.exchange(force_N, {});
    device_.sendForceEarly(force_N);
    while (const auto line = device_.nextMessage()) log_line_(*line);
    if (state.status == DeviceStatus::kLost)
      throw std::runtime_error("--check-device: the device stopped answering");
    if (state.status == DeviceStatus::kOk) position_mm_ = state.position_mm;
    return state.status == DeviceStatus::kOk;
  }

  HapticDevice& device_;
  const Clock& clock_;
  const std::atomic<bool>& stop_;
  const std::function<void(const std::string&)>& log_line_;
  LocalTime deadline_{};
  Vec3 position_mm_ = Vec3::Zero();
};

/// Key of a device in the file: one word of the letters that a key may have.
std::string toKey(const std::string& id) {
  std::string key = "d-" + id.substr(0, 60);
  std::replace_if(
      key.begin(), key.end(),
      [](char each) { return std::isalnum(static_cast<unsigned char>(each)) == 0; }, '-');
  return key;
}

std::vector<KeyValue> readChecks(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const auto lines = readKeyValues(in, file);
  return lines.ok() ? lines.value() : std::vector<KeyValue>();
}

}  // namespace

DeviceCheck judgeDevice(const Eigen::Matrix3d& response_mm) {
  DeviceCheck check{.response_mm = response_mm, .fault = {}};
  for (int axis = 0; axis < 3 && check.fault.empty(); ++axis) {
    const Vec3 moved_mm = response_mm.col(axis);
    const double along_mm = moved_mm[axis];
    const double aside_mm = (moved_mm - along_mm * Vec3::Unit(axis)).norm();
    const bool follows =
        along_mm >= kLeastResponse_mm && along_mm <= kMostResponse_mm && aside_mm < along_mm;
    if (follows && moved_mm.allFinite()) continue;
    check.fault = fmt::format("a push of {} N along {} moved the grip by {:.1f} {:.1f} {:.1f} mm",
                              kCheckPush_N, kAxisNames[static_cast<std::size_t>(axis)],
                              moved_mm.x(), moved_mm.y(), moved_mm.z());
  }
  return check;
}

std::optional<DeviceCheck> checkDevice(HapticDevice& device, const Clock& clock,
                                       const std::atomic<bool>& stop,
                                       const std::function<void(const std::string&)>& log_line) {
  CheckRun run(device, clock, stop, log_line);
  log_line("check: hold the grip loosely and still, in the middle; it will be pushed six times");
  Eigen::Matrix3d response_mm;
  try {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 force_N = kCheckPush_N * Vec3::Unit(axis);
      response_mm.col(axis) = 0.5 * (run.push(force_N) - run.push(-force_N));
    }
  } catch (const Stopped&) {
    return std::nullopt;
  }
  return judgeDevice(response_mm);
}

void storeCheck(const std::string& file, const std::string& id, const DeviceCheck& check) {
  auto lines = readChecks(file);
  const std::string key = toKey(id);
  std::erase_if(lines, [&](const KeyValue& line) { return line.key == key; });
  lines.push_back({0, key, check.fault.empty() ? "passed" : check.fault});
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), error);
  std::ofstream out(file);
  for (const KeyValue& line : lines) out << line.key << " = " << line.value << '\n';
  out.close();
  if (!out) throw std::runtime_error("--check-device: " + file + " cannot be written");
}

std::string readCheckFault(const std::string& file, const std::string& id) {
  for (const KeyValue& line : readChecks(file)) {
    if (line.key == toKey(id) && line.value != "passed") return line.value;
  }
  return "";
}

}  // namespace hapticast::client
