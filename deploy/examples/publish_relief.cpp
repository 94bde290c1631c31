// SPDX-License-Identifier: MIT
// Publishes a relief of its own: a ring of 60 mm that moves up and down once a second.
// Usage: publish_relief [PORT [SECONDS]]; touch it with hapticast-client localhost:PORT
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <thread>

#include "hapticast/publisher.hpp"

namespace {

/// Returns a ring with a round profile, `z_mm` high, in the middle of a picture of 640 x 480 px.
std::shared_ptr<const hapticast::HeightMap> makeRing(double z_mm) {
  auto ring = std::make_shared<hapticast::HeightMap>(200, 120, 240, 240);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 240; ++u) {
      const double from_middle = (std::hypot(u - 119.5, v - 119.5) - 80.0) / 30.0;
      if (std::abs(from_middle) >= 1.0) continue;
      ring->set(u, v, static_cast<float>(z_mm + 8.0 * std::sqrt(1.0 - from_middle * from_middle)));
    }
  }
  return ring;
}

void publish(const std::string& port, double seconds) {
  hapticast::PublisherSettings settings;
  settings.info.name = "ring";
  settings.listen = "[::]:" + port;
  hapticast::Publisher publisher(settings);
  std::printf("publishing on port %d\n", publisher.port());
  std::fflush(stdout);
  hapticast::Frame frame;
  hapticast::Object& ring = frame.objects.emplace_back();
  for (int i = 0; i < 25.0 * seconds; ++i) {
    const double w = 2.0 * 3.141592653589793, t = i / 25.0;
    ring.heights = makeRing(10.0 + 5.0 * std::sin(w * t));
    ring.position_mm.z() = 10.0 + 5.0 * std::sin(w * t);
    ring.velocity_mm_s.z() = 5.0 * w * std::cos(w * t);
    ring.acceleration_mm_s2.z() = -5.0 * w * w * std::sin(w * t);
    publisher.publish(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(40));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  publish(argc > 1 ? argv[1] : "7447", argc > 2 ? std::atof(argv[2]) : 1e9);
} catch (const std::exception& error) {
  std::fprintf(stderr, "publish_relief: %s\n", error.what());
  return 1;
}
