// SPDX-License-Identifier: MIT
// Renders a drawn stream by the client under the virtual clock, and writes messages, positions and
// forces to a file, for the test of the Python package. Usage: reference_run SEED FILE
// The file, little-endian: u32 messages, each f64 arrival_s, u32 bytes, the bytes; u32 ticks, each
// f64 time_s, 3 f64 position (device mm), 3 f64 force (N).
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "client/device/profile/device_profile.hpp"
#include "tests/support/drawn_stream.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace {

using namespace hapticast;

template <class T>
void write(std::ofstream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void writeMessages(std::ofstream& out, const std::vector<testing::ArrivedMessage>& messages) {
  write(out, static_cast<std::uint32_t>(messages.size()));
  for (const auto& each : messages) {
    write(out, toSeconds(each.arrival));
    write(out, static_cast<std::uint32_t>(each.bytes.size()));
    out.write(reinterpret_cast<const char*>(each.bytes.data()),
              static_cast<std::streamsize>(each.bytes.size()));
  }
}

void writeTicks(std::ofstream& out, const std::vector<testing::ArrivedMessage>& messages) {
  constexpr int kTicks = 3000;
  client::RendererSettings settings;
  settings.profile = client::loadDeviceProfile("omni");
  client::VirtualViewer viewer(settings, client::loadDeviceProfile("omni"), client::Hand{},
                               nullptr);
  const auto device = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
  client::TickReport last;
  std::size_t next = 0;
  write(out, std::uint32_t{kTicks});
  for (int i = 1; i <= kTicks; ++i) {
    const LocalTime now = localTime(1.0) + i * kTickPeriod;
    for (; next < messages.size() && messages[next].arrival <= now; ++next) {
      viewer.moveTo(messages[next].arrival);
      if (!viewer.receive(messages[next].bytes)) std::exit(1);
    }
    viewer.moveTo(now - kTickPeriod);
    const Vec3 hand_mm = device.toNominal(testing::chooseHand(last, 1e-3 * i));
    viewer.nail(hand_mm);
    last = viewer.tick();
    write(out, toSeconds(now));
    const Vec3 position_mm = device.toDevice(hand_mm);
    for (const double each : position_mm) write(out, each);
    for (const double each : last.force_N) write(out, each);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto messages =
      testing::DrawnStream(std::strtoull(argv[1], nullptr, 10)).draw(localTime(1.0), 3.0);
  std::ofstream out(argv[2], std::ios::binary);
  writeMessages(out, messages);
  writeTicks(out, messages);
  return out.flush() ? 0 : 1;
}
