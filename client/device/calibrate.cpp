// SPDX-License-Identifier: MIT
#include "client/device/calibrate.hpp"

#include <fmt/core.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "client/haptics/tick_report.hpp"
#include "common/text.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {

// Chosen: stable for a gain three times too large, and stiff enough for a third of the gain.
constexpr double kStiffness_N_mm = 0.2;
constexpr double kDamping_Ns_mm = 0.003;
constexpr double kIntegral_N_mm_s = 0.4;
constexpr double kMost_N = 6.0;
constexpr double kFilter = 0.2;   // low-pass of the velocity, share per tick
constexpr double kRest_mm = 0.3;  // seven counts
constexpr int kCalibrationRest_ticks = 2000;
constexpr double kStandardGravity_m_s2 = 9.80665;
constexpr double kNoticed = 0.2;  // share of the weight that has to appear in the force
constexpr int kLetGo_ticks = 1000;
constexpr int kSinks_ticks = 200;  // at the largest force for so long: the weight sinks
constexpr auto kCalibrationPatience = std::chrono::seconds(180);

/// Runs the ticks of a device while it holds its grip.
struct Hold {
  HapticDevice& device;
  const Clock& clock;
  const std::atomic<bool>& stop;
  const std::function<void(const std::string& line)>& log;
  GripHolder holder{};
  Vec3 force_N = Vec3::Zero();
  LocalTime deadline{};
  int at_most_ticks = 0;

  DeviceState poll() {
    device.waitForTick(deadline);
    deadline = clock.now() + kTickPeriod;
    DeviceState state = device.exchange(force_N, {});
    while (const auto line = device.nextMessage()) log(*line);
    return state;
  }
  /// Returns the force at rest once `good` accepts it.
  std::optional<Vec3> rest(const std::function<bool(const Vec3&)>& good) {
    holder.begin();
    const LocalTime until = clock.now() + kCalibrationPatience;
    while (!stop && clock.now() < until) {
      const DeviceState state = poll();
      // A weight that falls leaves the workspace, and the device then has to be homed again.
      if (state.status == DeviceStatus::kLost && at_most_ticks > 0) throwTooHeavy();
      if (state.status == DeviceStatus::kLost)
        throw std::runtime_error(
            "calibration: the device stopped answering; check its cable and power supply, "
            "and start again");
      if (state.status != DeviceStatus::kOk) continue;
      force_N = holder.hold(state.position_mm);
      requireHeld();
      device.sendForceEarly(force_N);
      auto rest_N = holder.restForce_N();
      if (!rest_N) continue;
      if (good(*rest_N)) return rest_N;
      holder.begin();
    }
    if (!stop)
      throw std::runtime_error(
          "calibration: the grip did not rest in the middle in time; start again");
    return std::nullopt;
  }
  /// The largest force does not hold a weight that is too heavy for the present gain. The force
  /// then remains while the weight sinks, and ramps down. Throws after that.
  void requireHeld() {
    at_most_ticks = force_N.norm() > 0.99 * kMost_N ? at_most_ticks + 1 : 0;
    if (at_most_ticks < kSinks_ticks) return;
    log("calibration: hold the weight with your hand: the force ends now");
    release();
    throwTooHeavy();
  }
  [[noreturn]] static void throwTooHeavy() {
    throw std::runtime_error(
        "calibration: the motors cannot hold this weight with the present gain: start again "
        "with half of it");
  }
  /// Ramps the force down. A weight without a hand falls then and may cause an implausible
  /// position. That is no reason to lose the measurement.
  void release() {
    const Vec3 from_N = force_N;
    for (int i = kLetGo_ticks - 1; i >= 0; --i) {
      (void)poll();
      force_N = from_N * (static_cast<double>(i) / kLetGo_ticks);
      device.sendForceEarly(force_N);
    }
    (void)poll();
  }
};

}  // namespace

Vec3 GripHolder::hold(const Vec3& position_mm) noexcept {
  if (!started_) last_mm_ = position_mm;
  started_ = true;
  velocity_mm_s_ += kFilter * ((position_mm - last_mm_) / kTick_s - velocity_mm_s_);
  last_mm_ = position_mm;
  integral_N_ -= kIntegral_N_mm_s * kTick_s * position_mm;
  if (integral_N_.norm() > kMost_N) integral_N_ *= kMost_N / integral_N_.norm();
  Vec3 force_N = integral_N_ - kStiffness_N_mm * position_mm - kDamping_Ns_mm * velocity_mm_s_;
  if (force_N.norm() > kMost_N) force_N *= kMost_N / force_N.norm();
  const bool rests = position_mm.norm() < kRest_mm;
  if (!rests || rest_ticks_ == 0) sum_N_ = Vec3::Zero();
  rest_ticks_ = rests ? rest_ticks_ + 1 : 0;
  sum_N_ += force_N;
  return force_N;
}

std::optional<Vec3> GripHolder::restForce_N() const noexcept {
  if (rest_ticks_ < kCalibrationRest_ticks) return std::nullopt;
  return Vec3(sum_N_ / rest_ticks_);
}

std::optional<double> calibrate(HapticDevice& device, const Clock& clock, double gain,
                                double weight_g, const std::atomic<bool>& stop,
                                const std::function<void(const std::string& line)>& log_line) {
  const double weight_N = 1e-3 * weight_g * kStandardGravity_m_s2;
  Hold hold{device, clock, stop, log_line};
  hold.deadline = clock.now() + kTickPeriod;
  log_line(
      "calibration: 1. home the device, move the grip to the middle and release it; the motors "
      "hold it there");
  const auto empty_N = hold.rest([](const Vec3&) { return true; });
  std::optional<Vec3> loaded_N;
  if (empty_N) {
    log_line(fmt::format("calibration: 2. hang {:g} g on the grip and release it", weight_g));
    loaded_N = hold.rest(
        [&](const Vec3& force_N) { return (force_N - *empty_N).norm() > kNoticed * weight_N; });
  }
  if (loaded_N) log_line("calibration: 3. hold the weight with your hand: the force ends now");
  hold.release();
  if (!loaded_N) return std::nullopt;
  return gain * (*loaded_N - *empty_N).norm() / weight_N;
}

void storeGain(const std::string& file, double gain) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  bool replaced = false;
  for (std::string line; std::getline(in, line);) {
    const std::size_t equals = line.find('=');
    const bool its = equals != std::string::npos &&
                     trim(std::string_view(line).substr(0, equals)) == "falcon-gain";
    if (its && !replaced) line = fmt::format("falcon-gain = {:.0f}", gain);
    replaced = replaced || its;
    lines.push_back(line);
  }
  if (!replaced) lines.push_back(fmt::format("falcon-gain = {:.0f}", gain));
  std::ofstream out(file);
  for (const std::string& line : lines) out << line << '\n';
  out.close();
  if (!out)
    throw std::runtime_error("--config " + file +
                             ": cannot be written; is its folder there and writable?");
}

}  // namespace hapticast::client
