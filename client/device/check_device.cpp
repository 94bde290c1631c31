// SPDX-License-Identifier: MIT
#include "client/device/check_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "client/haptics/tick_report.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr double kCheckPush_N = 0.3;  // chosen: no hand at the grip, and a grip that falls is safe
// To, fro and to, so that a free grip ends where it began.
constexpr Duration::rep kPush_ticks = 30;
constexpr Duration::rep kRecord_ticks = 130;  // of a push, until shortly after its end
constexpr Duration kPushAndSettle = (kRecord_ticks + 60) * kTickPeriod;
// Of a grip at rest, before the first push. The process of a driver lets a force return within
// 500 ms after a pause of the client.
constexpr auto kStill = std::chrono::milliseconds(600);
constexpr double kStill_mm = 1.0;
// Between two readings. After twice as long the process of a driver reduces the force.
constexpr auto kLongestGap = std::chrono::milliseconds(5);
// Median of a push. A machine with longer ones delays each force by more than a device may.
constexpr auto kLongestMedian = std::chrono::milliseconds(2);
constexpr int kMostRepeats = 10;  // chosen: pushes that a busy machine spoils
constexpr auto kStillPatience = std::chrono::seconds(60);
// 0.3 N move a free grip of 0.5 kg by 0.5 mm.
constexpr double kLeastResponse_mm = 0.2;
constexpr double kMostCount = 1.5;  // of the profile's count
constexpr double kLeastMass = 0.8;  // of the profile's mass; the fit is exact to 15 %
constexpr double kHeldMass = 3.0;   // of the profile's mass: a hand of 100 g and more
constexpr const char* kTooBusy =
    "check: this machine is too busy for the check; close other programs";
constexpr std::array<const char*, 3> kAxisNames{"x (right)", "y (up)", "z (towards you)"};

/// The check was stopped.
struct Stopped {};

/// Returns the force of a push.
double computePush_N(Duration since_begin) {
  const auto ticks = since_begin / kTickPeriod;
  if (ticks >= 4 * kPush_ticks) return 0.0;
  const bool back = ticks >= kPush_ticks && ticks < 3 * kPush_ticks;
  return back ? -kCheckPush_N : kCheckPush_N;
}

/// One tick of a push.
struct Sample {
  LocalTime at;
  double force_N;
  Vec3 position_mm;
};

/// Returns the smallest step of the readings on any axis; infinity without one.
double findStep_mm(const std::vector<Sample>& samples) {
  constexpr double kRounding_mm = 1e-6;
  double smallest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    for (const double step_mm : samples[i].position_mm - samples[i - 1].position_mm) {
      if (std::abs(step_mm) > kRounding_mm) smallest_mm = std::min(smallest_mm, std::abs(step_mm));
    }
  }
  return smallest_mm;
}

Duration findMedianTick(const std::vector<Sample>& samples) {
  std::vector<Duration> ticks;
  for (std::size_t i = 1; i < samples.size(); ++i)
    ticks.push_back(samples[i].at - samples[i - 1].at);
  std::nth_element(ticks.begin(), ticks.begin() + std::ssize(ticks) / 2, ticks.end());
  return ticks[ticks.size() / 2];
}

/// Returns the push at each millisecond since its begin: the device holds a force until the next
/// one, and the grip moves evenly between two readings.
PushRecord resample(const std::vector<Sample>& samples) {
  PushRecord record;
  record.step_mm = findStep_mm(samples);
  std::size_t next = 1;
  for (Duration::rep i = 0; i < kRecord_ticks; ++i) {
    const LocalTime at = samples.front().at + i * kTickPeriod;
    while (next + 1 < samples.size() && samples[next].at <= at) ++next;
    const Sample& from = samples[next - 1];
    const Sample& to = samples[next];
    const double share = toSeconds(at - from.at) / toSeconds(to.at - from.at);
    record.force_N.push_back(from.force_N);
    record.position_mm.push_back(from.position_mm + share * (to.position_mm - from.position_mm));
  }
  return record;
}

/// Runs the ticks of the device.
class CheckRun {
 public:
  CheckRun(HapticDevice& device, const Clock& clock, const std::atomic<bool>& stop,
           const std::function<void(const std::string&)>& log_line)
      : device_(device), clock_(clock), stop_(stop), log_line_(log_line) {}
  ~CheckRun() { (void)device_.exchange(Vec3::Zero(), {}); }
  CheckRun(const CheckRun&) = delete;
  CheckRun& operator=(const CheckRun&) = delete;

  /// Waits until the grip rests.
  void waitForRest() {
    const LocalTime until = clock_.now() + kStillPatience;
    std::optional<LocalTime> begin;  // of the rest
    bool was_late = false;
    Vec3 begin_mm = Vec3::Zero();
    while (!begin || now_ < *begin + kStill) {
      if (clock_.now() > until)
        throw std::runtime_error(was_late ? kTooBusy
                                          : "check: the grip did not come to rest for a minute");
      beginTick();
      const bool fresh = exchange(Vec3::Zero());
      if (std::exchange(gap_, false)) {
        was_late = was_late || begin;
        begin.reset();
      }
      if (!fresh || (begin && (position_mm_ - begin_mm).norm() <= kStill_mm)) continue;
      begin = now_;
      begin_mm = position_mm_;
    }
  }
  /// Pushes along an axis, to and fro. Returns the recording. Repeats a push with late ticks, and
  /// one that the process of the driver reduced.
  PushRecord push(int axis, double sign) {
    while (true) {
      const std::uint64_t reduced = countReduced();
      const std::vector<Sample> samples = pushOnce(axis, sign);
      const bool late = std::exchange(gap_, false) || findMedianTick(samples) > kLongestMedian;
      if (!late && countReduced() == reduced) return resample(samples);
      if (++repeats_ > kMostRepeats) throw std::runtime_error(kTooBusy);
      waitForRest();
    }
  }

 private:
  std::vector<Sample> pushOnce(int axis, double sign) {
    std::vector<Sample> samples;
    do {
      beginTick();
      const LocalTime begin = samples.empty() ? now_ : samples.front().at;
      const double force_N = sign * computePush_N(now_ - begin);
      (void)exchange(force_N * Vec3::Unit(axis));
      samples.push_back({now_, force_N, position_mm_});
    } while (now_ < samples.front().at + kPushAndSettle);
    return samples;
  }
  /// Returns the number of ticks in which the process of the driver reduced the force.
  [[nodiscard]] std::uint64_t countReduced() const {
    const auto traffic = device_.traffic();
    return traffic ? traffic->reduced : 0;
  }
  void beginTick() {
    if (stop_) throw Stopped();
    device_.waitForTick(deadline_);
    now_ = clock_.now();
    deadline_ = now_ + kTickPeriod;
  }
  /// Returns true if the device has a new position.
  bool exchange(const Vec3& force_N) {
    const DeviceState state = device_.exchange(force_N, {});
    device_.sendForceEarly(force_N);
    while (const auto line = device_.nextMessage()) log_line_(*line);
    if (state.status == DeviceStatus::kLost)
      throw std::runtime_error("check: the device stopped answering");
    if (state.status != DeviceStatus::kOk) return false;
    position_mm_ = state.position_mm;
    gap_ = gap_ || now_ > last_reading_ + kLongestGap;
    last_reading_ = now_;
    return true;
  }

  HapticDevice& device_;
  const Clock& clock_;
  const std::atomic<bool>& stop_;
  const std::function<void(const std::string&)>& log_line_;
  LocalTime now_{};  // begin of the tick
  LocalTime deadline_{};
  LocalTime last_reading_{};
  bool gap_ = false;  // between two readings, since it was read
  int repeats_ = 0;
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

/// Returns the largest motion along the axis until the push fro has stopped the grip. Later a grip
/// with damping moves farther to the other side.
Vec3 findLargest(const PushRecord& record, int axis) {
  Vec3 largest_mm = Vec3::Zero();
  for (Duration::rep i = 0; i < 2 * kPush_ticks + kMostFittedDelay_ticks; ++i) {
    const Vec3 moved_mm =
        record.position_mm[static_cast<std::size_t>(i)] - record.position_mm.front();
    if (std::abs(moved_mm[axis]) > std::abs(largest_mm[axis])) largest_mm = moved_mm;
  }
  return largest_mm;
}

MotionFit fitPush(const PushRecord& record, int axis) {
  std::vector<double> along_mm;
  along_mm.reserve(record.position_mm.size());
  for (const Vec3& each_mm : record.position_mm) along_mm.push_back(each_mm[axis]);
  return fitMotion(record.force_N, along_mm);
}

/// Returns the fault in sign or axis of the motion along an axis, or an empty text.
std::string findWrongMotion(const Vec3& moved_mm, int axis) {
  const double along_mm = moved_mm[axis];
  const double aside_mm = (moved_mm - along_mm * Vec3::Unit(axis)).norm();
  if (moved_mm.allFinite() && along_mm >= kLeastResponse_mm && 2.0 * aside_mm < along_mm) return "";
  const bool small = moved_mm.norm() < kLeastResponse_mm;
  return fmt::format("a push of {} N along {} moved the grip by {:.1f} {:.1f} {:.1f} mm{}",
                     kCheckPush_N, kAxisNames[static_cast<std::size_t>(axis)], moved_mm.x(),
                     moved_mm.y(), moved_mm.z(), small ? ": let go of the grip" : "");
}

/// Returns what of the measured values a profile cannot have, or an empty text.
std::string findWrongProfile(const DeviceCheck& check, const DeviceProfile& profile) {
  if (check.count_mm > kMostCount * profile.count_mm)
    return fmt::format("its position moves in steps of {:.3f} mm, its profile has count_mm = {:g}",
                       check.count_mm, profile.count_mm);
  if (!(check.mass_kg <= kHeldMass * profile.mass_kg))
    return fmt::format(
        "it moved like {:.0f} g, its profile has {:.0f} g: let go of the grip, or "
        "correct mass_kg",
        1e3 * check.mass_kg, 1e3 * profile.mass_kg);
  if (check.delay_ticks > kMostDelay_ticks)
    return fmt::format("{} ms pass from a position to its force; at most {} ms are stable",
                       check.delay_ticks, kMostDelay_ticks);
  return "";
}

std::string describeChanges(const DeviceCheck& check, const DeviceProfile& profile) {
  DeviceProfile changed = profile;
  applyCheck(check, changed);
  std::string note;
  if (changed.mass_kg != profile.mass_kg)
    note = fmt::format("it moves like {:.0f} g, not {:.0f} g", 1e3 * changed.mass_kg,
                       1e3 * profile.mass_kg);
  if (changed.delay_ticks != profile.delay_ticks)
    note += fmt::format("{}{} ms pass from a position to its force, not {} ms",
                        note.empty() ? "" : "; ", changed.delay_ticks, profile.delay_ticks);
  return note.empty() ? note : note + ": walls are softer";
}

}  // namespace

DeviceCheck judgeDevice(const std::array<PushRecord, 6>& pushes, const DeviceProfile& profile) {
  DeviceCheck check;
  check.mass_kg = check.count_mm = std::numeric_limits<double>::infinity();
  std::vector<int> delays_ticks;
  for (int axis = 0; axis < 3 && check.fault.empty(); ++axis) {
    const PushRecord& to = pushes[static_cast<std::size_t>(2 * axis)];
    const PushRecord& fro = pushes[static_cast<std::size_t>(2 * axis + 1)];
    check.fault = findWrongMotion(0.5 * (findLargest(to, axis) - findLargest(fro, axis)), axis);
    for (const PushRecord* const push : {&to, &fro}) {
      const MotionFit fit = fitPush(*push, axis);
      check.mass_kg = std::min(check.mass_kg, fit.mass_kg);
      delays_ticks.push_back(fit.delay_ticks);
    }
    if (check.fault.empty() && !(check.mass_kg > 0.0))
      check.fault = fmt::format("the grip does not follow a push along {}",
                                kAxisNames[static_cast<std::size_t>(axis)]);
  }
  std::sort(delays_ticks.begin(), delays_ticks.end());
  check.delay_ticks = delays_ticks[delays_ticks.size() / 2];
  for (const PushRecord& record : pushes) check.count_mm = std::min(check.count_mm, record.step_mm);
  if (check.fault.empty()) check.fault = findWrongProfile(check, profile);
  if (check.fault.empty()) check.note = describeChanges(check, profile);
  return check;
}

void applyCheck(const DeviceCheck& check, DeviceProfile& profile) {
  if (check.mass_kg < kLeastMass * profile.mass_kg) profile.mass_kg = check.mass_kg;
  profile.delay_ticks = std::max(profile.delay_ticks, check.delay_ticks);
}

std::optional<DeviceCheck> checkDevice(HapticDevice& device, const Clock& clock,
                                       const std::atomic<bool>& stop,
                                       const std::function<void(const std::string&)>& log_line) {
  CheckRun run(device, clock, stop, log_line);
  std::array<PushRecord, 6> pushes;
  try {
    run.waitForRest();
    for (std::size_t i = 0; i < pushes.size(); ++i)
      pushes[i] = run.push(static_cast<int>(i / 2), i % 2 == 0 ? 1.0 : -1.0);
  } catch (const Stopped&) {
    return std::nullopt;
  }
  return judgeDevice(pushes, device.profile());
}

namespace {
/// Identifies the values of a profile that a check compares. The delay is none of them: the start
/// of a driver measures it anew, and applyCheck() only raises it.
std::string describeProfile(const DeviceProfile& profile) {
  return fmt::format("{:g} {:g}", profile.mass_kg, profile.count_mm);
}
}  // namespace

void storeCheck(const std::string& file, const std::string& id, const DeviceProfile& profile,
                const DeviceCheck& check) {
  auto lines = readChecks(file);
  const std::string key = toKey(id);
  std::erase_if(lines, [&](const KeyValue& line) { return line.key == key; });
  if (check.fault.empty())
    lines.push_back(
        {0, key,
         fmt::format("{}: {:g} {}", describeProfile(profile), check.mass_kg, check.delay_ticks)});
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), error);
  std::ofstream out(file);
  for (const KeyValue& line : lines) out << line.key << " = " << line.value << '\n';
  out.close();
  if (!out) throw std::runtime_error("check: " + file + " cannot be written");
}

std::optional<DeviceCheck> readCheck(const std::string& file, const std::string& id,
                                     const DeviceProfile& profile) {
  const std::string profile_part = describeProfile(profile) + ": ";
  for (const KeyValue& line : readChecks(file)) {
    if (line.key != toKey(id) || !line.value.starts_with(profile_part)) continue;
    DeviceCheck check;
    std::istringstream in(line.value.substr(profile_part.size()));
    if (in >> check.mass_kg >> check.delay_ticks && check.mass_kg > 0.0) return check;
  }
  return std::nullopt;
}

}  // namespace hapticast::client
