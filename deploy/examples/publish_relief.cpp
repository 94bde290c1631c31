// SPDX-License-Identifier: MIT
// Publishes a relief of its own: a dome of 55 mm that moves up and down once a second.
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

/// Returns a dome on a plane at `z_mm`, in the middle of a picture of 640 x 480 px.
std::shared_ptr<const hapticast::HeightMap> makeDome(double z_mm) {
  auto dome = std::make_shared<hapticast::HeightMap>(200, 120, 240, 240);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 240; ++u) {
      const double radius = std::hypot(u - 119.5, v - 119.5) / 110.0;
      if (radius >= 1.0) continue;
      dome->set(u, v, static_cast<float>(z_mm + 8.0 * std::sqrt(1.0 - radius * radius)));
    }
  }
  return dome;
}

void publish(const std::string& port, double seconds) {
  hapticast::PublisherSettings settings;
  settings.info.name = "dome";
  settings.listen = "[::]:" + port;
  hapticast::Publisher publisher(settings);
  std::printf("publishing on port %d\n", publisher.port());
  std::fflush(stdout);
  hapticast::Frame frame;
  hapticast::Object& dome = frame.objects.emplace_back();
  for (int i = 0; i < 25.0 * seconds; ++i) {
    const double w = 2.0 * 3.141592653589793, t = i / 25.0;
    dome.heights = makeDome(10.0 + 5.0 * std::sin(w * t));
    dome.position_mm.z() = 10.0 + 5.0 * std::sin(w * t);
    dome.velocity_mm_s.z() = 5.0 * w * std::cos(w * t);
    dome.acceleration_mm_s2.z() = -5.0 * w * w * std::sin(w * t);
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
