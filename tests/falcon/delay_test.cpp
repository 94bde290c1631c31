// SPDX-License-Identifier: MIT
// Delay from a force of the loop to the motors: through the helper process, and with the driver in
// this process. It prints both and asserts only that all forces arrive.
#include <algorithm>
#include <cstdio>

#include "client/device/falcon/falcon_driver.hpp"
#include "client/device/loop/realtime_thread.hpp"
#include "tests/falcon/falcon_fixture.hpp"

namespace hapticast::testing {
namespace {

constexpr int kSteps = 60;
constexpr int kTicksPerStep = 40;
constexpr int kWarmUp_ticks = 1500;  // homing, ramps

class FalconDelay : public FalconTest {
 protected:
  /// Calls tick(force) 1000 times a second and changes the force now and then; tick() returns the
  /// time at which it handed the force over. Returns the delays in µs, sorted.
  template <class Tick>
  std::vector<double> measure(Tick tick) {
    std::vector<LocalTime> changes;
    std::thread loop([&] {
      (void)client::requestRealtime();
      for (int i = 0; i < kWarmUp_ticks + kSteps * kTicksPerStep; ++i) {
        const int step = std::max(0, i - kWarmUp_ticks) / kTicksPerStep;
        const LocalTime at = tick(0.2 + 0.2 * (step % 2));
        if (i >= kWarmUp_ticks && (i - kWarmUp_ticks) % kTicksPerStep == 0 && step > 0)
          changes.push_back(at);
      }
    });
    loop.join();
    std::vector<double> delays_us;
    const auto all = received();
    for (const LocalTime change : changes) {
      const auto before = std::find_if(all.begin(), all.end(), [&](const ReceivedRequest& each) {
        return each.at > change - std::chrono::milliseconds(5);
      });
      const auto after = std::find_if(before, all.end(), [&](const ReceivedRequest& each) {
        return each.at > change && changed(before->request.motors, each.request.motors);
      });
      if (after != all.end()) delays_us.push_back(1e6 * toSeconds(after->at - change));
    }
    std::sort(delays_us.begin(), delays_us.end());
    return delays_us;
  }
  /// The force has doubled or halved; the pose adds a few counts.
  static bool changed(const std::array<int, 3>& a, const std::array<int, 3>& b) {
    const auto size = [](const std::array<int, 3>& motors) {
      return std::abs(motors[0]) + std::abs(motors[1]) + std::abs(motors[2]);
    };
    return size(a) > 1.5 * size(b) || size(b) > 1.5 * size(a);
  }
  static void print(const char* what, const std::vector<double>& delays_us) {
    ASSERT_GT(delays_us.size(), kSteps / 2U);
    std::printf("%s: %.0f us (median), %.0f us (99 %%), %zu forces\n", what,
                delays_us[delays_us.size() / 2], delays_us[delays_us.size() * 99 / 100],
                delays_us.size());
  }
};

TEST_F(FalconDelay, ThroughTheHelperAndInThisProcess) {
  bootAndPlugIn();
  for (int round = 0; round < 2; ++round) {
    {
      const auto device = openFalcon();
      LocalTime last = clock_.now();
      print("helper", measure([&](double force_N) {
              device->waitForTick(last + std::chrono::milliseconds(1));
              last = clock_.now();
              (void)device->exchange(Vec3(0.0, 0.0, force_N), {});
              device->sendForceEarly(Vec3(0.0, 0.0, force_N));
              return last;
            }));
    }
    const hapticast_host host{sizeof host, nullptr, [](void*, const char*) {},
                              [](void*, const char*) -> const char* { return nullptr; }};
    hapticast_profile profile{};
    char why[256] = "";
    const hapticast_driver& driver = *client::falconDriver();
    hapticast_device* const device = driver.open(&host, nullptr, &profile, why);
    ASSERT_NE(device, nullptr) << why;
    print("in process", measure([&](double force_N) {
            (void)driver.wait(
                device, (clock_.now() + std::chrono::milliseconds(1)).time_since_epoch().count());
            const LocalTime now = clock_.now();
            const double force[3] = {0.0, 0.0, force_N};
            hapticast_state state{};
            (void)driver.exchange(device, force, &state);
            return now;
          }));
    driver.close(device);
  }
}

}  // namespace
}  // namespace hapticast::testing
