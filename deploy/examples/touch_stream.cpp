// SPDX-License-Identifier: MIT
// Touches a stream with a virtual hand, 1,000 times a second, and prints the force.
// Usage: touch_stream [HOST:PORT [SECONDS]]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "hapticast/renderer.hpp"
#include "hapticast/stream.hpp"

namespace {

/// Waits until `time_s` of the clock of Stream::now().
void sleepUntil(double time_s) {
  const auto seconds = static_cast<std::time_t>(time_s);
  const timespec until{seconds, static_cast<long>(1e9 * (time_s - static_cast<double>(seconds)))};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

/// Returns where the hand goes, nominal mm: to the nearest object, and up and down on it.
Eigen::Vector3d chooseTarget(const hapticast::Tick& tick, double time_s) {
  if (tick.object_id == 0) return {0.0, 0.0, 40.0};
  const double above_mm = 2.0 + 4.0 * std::cos(3.0 * time_s);
  return {tick.object_mm.x(), tick.object_mm.y(), tick.height_mm + above_mm};
}

void touch(const char* address, double seconds) {
  hapticast::Renderer renderer;
  hapticast::Stream stream(address);
  stream.play(renderer);
  Eigen::Vector3d hand_mm(0.0, 0.0, 40.0);
  const double begin_s = hapticast::Stream::now();
  for (int i = 1; 1e-3 * i < seconds && !stream.ended(); ++i) {
    sleepUntil(begin_s + 1e-3 * i);
    const hapticast::Tick& tick =
        renderer.tick(hapticast::Stream::now(), renderer.toDevice(hand_mm));
    // A real program reads its device's position here, and sends tick.force_N to it.
    const Eigen::Vector3d way_mm = chooseTarget(tick, 1e-3 * i) - hand_mm;
    hand_mm += way_mm * std::fmin(1.0, 0.1 / std::fmax(way_mm.norm(), 1e-9));  // 100 mm/s
    while (stream.next(0.0)) {
    }
    if (i % 100 == 0)
      std::printf("%6.2f s  z %6.2f mm  force %5.2f N%s\n", 1e-3 * i, hand_mm.z(),
                  tick.force_N.norm(), tick.contact ? "  contact" : "");
  }
}

}  // namespace

int main(int argc, char** argv) try {
  touch(argc > 1 ? argv[1] : "localhost:7447", argc > 2 ? std::atof(argv[2]) : 10.0);
} catch (const std::exception& error) {
  std::fprintf(stderr, "touch_stream: %s\n", error.what());
  return 1;
}
