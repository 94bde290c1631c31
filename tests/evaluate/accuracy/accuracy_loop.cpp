// SPDX-License-Identifier: MIT
// Accuracy in the loop: the whole client with device, observer and prediction touches a surface
// that moves. The displacement of each tick is compared with the exact one at the true HIP, at the
// time when the force of that tick acts.
#include <cmath>
#include <memory>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"
#include "tests/evaluate/touch/stream_server.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::evaluate {

namespace {

struct LoopCase {
  std::string name;
  TouchScene scene;
  Hand hand;
  /// Exact displacement of a HIP at a time; zero outside the body.
  std::function<Vec3(const Vec3& hip_mm, double time_s)> truth;
  double required = 0.0;
  double aim = 0.0;
};

std::function<Vec3(const Vec3&, double)> sphereTruth(const TouchScene& scene, double radius_mm) {
  return [motion = scene.motion, radius_mm](const Vec3& hip_mm, double time_s) {
    const Vec3 from_mm = hip_mm - motion(time_s).position_mm;
    const double distance_mm = from_mm.norm();
    return distance_mm < radius_mm ? Vec3(from_mm * (radius_mm / distance_mm - 1.0))
                                   : Vec3(Vec3::Zero());
  };
}

std::vector<LoopCase> loopScenes() {
  const TouchScene still = stillSphere();
  const TouchScene sphere = movingSphere(40.0);
  const TouchScene rising = swingingSphere({0.0, 0.0, 4.0}, 1.5);
  const TouchScene thrown = swingingSphere({0.0, 20.0, 0.0}, 1.1);
  return {
      {"sphere at rest", still, slidingHand(still, 10.0), sphereTruth(still, 20.0), 3, 2},
      {"sphere, 40 px a frame", sphere, slidingHand(sphere, 7.0), sphereTruth(sphere, 15.0), 3, 2},
      {"sphere, 4 mm in z at 1.5 Hz", rising, slidingHand(rising, 10.0), sphereTruth(rising, 20.0),
       3, 2},
      {"sphere, 20 mm in y at 1.1 Hz", thrown, slidingHand(thrown, 10.0), sphereTruth(thrown, 20.0),
       5, 4}};
}

/// Sums the error from tick to tick. A displacement belongs to the tick in which its force acts.
class LoopError {
 public:
  LoopError(const LoopCase& what, const client::VirtualViewer& viewer, int delay_ticks)
      : what_(what), viewer_(viewer), delay_(static_cast<std::size_t>(delay_ticks)) {}

  void onReport(const client::TickReport& report) {
    displacement_mm_.push_back(report.contact ? Vec3(report.contact_mm - report.ahead_mm)
                                              : Vec3(Vec3::Zero()));
    const double time_s = toSeconds(report.play_time.time_since_epoch());
    if (displacement_mm_.size() <= delay_ || time_s < kFrom_s ||
        time_s > what_.scene.duration_s - 0.2)
      return;
    const Vec3 true_mm = what_.truth(viewer_.truePosition_mm(), time_s);
    if (true_mm == Vec3::Zero()) return;
    const Vec3& got_mm = displacement_mm_[displacement_mm_.size() - 1 - delay_];
    error_ += (got_mm - true_mm).squaredNorm();
    truth_ += true_mm.squaredNorm();
  }
  [[nodiscard]] double percent() const { return 100.0 * std::sqrt(error_ / truth_); }

 private:
  static constexpr double kFrom_s = 1.0;  // the hand has arrived, and the clock is synchronised
  const LoopCase& what_;
  const client::VirtualViewer& viewer_;
  std::size_t delay_;
  std::vector<Vec3> displacement_mm_;
  double error_ = 0.0, truth_ = 0.0;
};

double runLoop(const LoopCase& what, const Stream& stream, int delay_ticks) {
  client::RendererSettings settings;
  settings.profile.delay_ticks = delay_ticks;
  client::PlantProfile plant;
  static_cast<client::DeviceProfile&>(plant) = settings.profile;
  auto viewer =
      std::make_unique<client::VirtualViewer>(settings, plant, client::Hand::firm(), nullptr);
  viewer->lead([&](double time_s) { return what.hand(std::max(0.0, time_s)).hip_mm; });
  StreamServer server(stream, 0.0);
  LoopError error(what, *viewer, delay_ticks);
  (void)runSession(server, *viewer, what.scene.duration_s,
                   [&](const client::TickReport& report) { error.onReport(report); });
  return error.percent();
}

Outcome measureLoop(const LoopCase& what) {
  Outcome out;
  StreamKind kind;
  kind.scan = true;
  const Stream stream = makeStream(what.scene, kind);
  for (const int delay_ticks : {0, 1, 3}) {
    const double error = runLoop(what, stream, delay_ticks);
    const bool is_default = delay_ticks == client::DeviceProfile{}.delay_ticks;
    out.rows.push_back({what.name, "force, in the loop",
                        "delay " + std::to_string(delay_ticks) + " ticks", error, "%", 0.0,
                        is_default});
    if (is_default)
      out.goals.push_back({"force in the loop, " + what.name, "%", what.required, what.aim, error});
  }
  return out;
}

}  // namespace

std::vector<Case> loopCases(bool quick) {
  std::vector<Case> out;
  for (const LoopCase& what : loopScenes()) {
    if (quick && what.name == "sphere at rest") continue;
    out.emplace_back([what] { return measureLoop(what); });
  }
  return out;
}

}  // namespace hapticast::evaluate
