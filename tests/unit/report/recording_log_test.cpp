// SPDX-License-Identifier: MIT
// Curves of a recording: they keep peaks of one tick and count each loss; other files are refused.
#include "tests/evaluate/recording_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "client/desk/run_recorder.hpp"
#include "client/device/profile/device_profile.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/mcap_writer.hpp"
#include "common/recording/schemas.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/installed.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::evaluate {

namespace {

constexpr std::uint64_t kTicks = 20'000;

/// A frame of an object whose relief has several slices.
CodedFrame makeSliced(std::uint64_t id) {
  HapticFrame frame;
  frame.id = id;
  frame.media_time = mediaTime(20.0 + 0.04 * static_cast<double>(id));
  HapticObject& object = frame.objects.emplace_back();
  object.changed_in_frame = id;
  const auto relief = flatRelief({0, 0, 100, 40});
  for (std::size_t i = 0; i < relief->height_mm.size(); ++i)
    relief->height_mm[i] = static_cast<float>(i * 7919 % 1000) * 0.02F;
  object.relief = relief;
  return FrameCoder().code(frame);
}

const Curve& findCurve(const RecordingCurves& curves, const std::string& title,
                       const std::string& name) {
  for (const CurvePanel& panel : curves.panels) {
    if (panel.title != title) continue;
    for (const Curve& curve : panel.curves) {
      if (curve.name == name) return curve;
    }
  }
  throw std::runtime_error("no curve " + title + ", " + name);
}

double largest(const Curve& curve) {
  return std::max_element(curve.points.begin(), curve.points.end(),
                          [](auto& a, auto& b) { return a.y < b.y; })
      ->y;
}

class RecordingLog : public ::testing::Test {
 protected:
  /// Records 20 s: frame 7 is missing, frame 9 lacks a slice, frame 11 is dropped.
  [[nodiscard]] std::string recordRun() const {
    ManualClock clock;
    client::RunRecorder recorder({(folder_ / "run.mcap").string(), std::nullopt}, clock);
    recorder.onSettings({.profile = client::loadDeviceProfile("omni")});
    client::StreamTiming timing;
    timing.number = 1;
    timing.connected = true;
    timing.clock_offset = std::chrono::seconds(19);  // local time 1 s is media time 20 s
    recorder.onTiming(timing, true);
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      if (tick % 40 == 30 && tick / 40 != 7) recordFrame(recorder, tick / 40);
      client::TickReport report;
      report.tick = tick + 1;
      report.time = clock.now();
      report.playout_delay = std::chrono::milliseconds(80);
      report.force_N = {0.0, 0.0, tick == 14'321 ? 3.0 : 1.0};
      report.lookup =
          tick % 100 == 0 ? client::Lookup::kExtrapolated : client::Lookup::kInterpolated;
      report.safety_actions = tick < 10 ? 1U << 5U : 0U;  // slew
      recorder.onTick(report);
      clock.advance(kTickPeriod);
    }
    return (folder_ / "run.mcap").string();
  }
  static void recordFrame(client::RunRecorder& recorder, std::uint64_t id) {
    client::AssembledFrame frame;
    frame.frame = makeSliced(id);
    if (id == 9) {
      auto part = std::make_shared<CodedRelief>(*frame.frame.objects[0].relief);
      part->slices.pop_back();
      frame.frame.objects[0].relief = part;
    }
    recorder.onFrame(frame);
    client::PreparedFrame prepared;
    prepared.id = id;
    prepared.handed_over = id != 11;
    recorder.onPrepared(prepared);
  }

  TempFolder folder_;
};

TEST_F(RecordingLog, KeepsPeaksAndCountsLosses) {
  const RecordingCurves curves = readCurves(recordRun());
  EXPECT_EQ(curves.line, "20.0 s of a client");
  const Curve& force = findCurve(curves, "Force", "at the device");
  EXPECT_EQ(largest(force), 3.0);
  EXPECT_LT(force.points.size(), 2000U);
  for (const char* name : {"frames lost", "slices lost", "frames dropped"})
    EXPECT_EQ(findCurve(curves, "Losses so far", name).points.back().y, 1.0) << name;
  EXPECT_EQ(findCurve(curves, "Ticks so far without two frames to interpolate", "extrapolated")
                .points.back()
                .y,
            kTicks / 100);
  EXPECT_EQ(findCurve(curves, "Ticks so far in which the safety chain changed the force", "slew")
                .points.back()
                .y,
            10.0);
  EXPECT_NEAR(largest(findCurve(curves, "Delay", "arrival of a frame")), 30.0, 1e-3);
  EXPECT_EQ(largest(findCurve(curves, "Delay", "playout delay")), 80.0);
}

TEST_F(RecordingLog, DrawsTheStreamOfAServer) {
  const std::string file = (folder_ / "stream.mcap").string();
  {
    McapWriter writer(file, {makeChannel("/frame", "hapticast.proto.HapticFrame")});
    for (const std::uint64_t id : {1U, 2U, 3U, 8U}) {
      const CodedFrame frame = makeSliced(id);
      writer.write(0, static_cast<std::uint64_t>(frame.media_time.time_since_epoch().count()),
                   findContent(encode(frame)));
    }
  }
  const RecordingCurves curves = readCurves(file);
  EXPECT_EQ(curves.line, "0.3 s of a server");
  EXPECT_NEAR(largest(findCurve(curves, "Time since the frame before", "")), 200.0, 1e-3);
  EXPECT_EQ(largest(findCurve(curves, "Objects", "with new heights")), 1.0);
  EXPECT_GT(largest(findCurve(curves, "Size", "frame")), 1.0);
  plotRecording(file, folder_ / "plots");
  const bool can_draw = isInstalled("gnuplot");
  EXPECT_EQ(std::filesystem::exists(folder_ / "plots/log.png"), can_draw);
}

TEST_F(RecordingLog, RefusesOtherFilesAndNamesDamage) {
  EXPECT_THROW((void)readCurves("/no/such.mcap"), std::runtime_error);
  EXPECT_THROW((void)readCurves(folder_.write("text.mcap", "text")), std::runtime_error);
  std::ifstream in(recordRun(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const RecordingCurves cut =
      readCurves(folder_.write("cut.mcap", bytes.substr(0, bytes.size() / 2)));
  EXPECT_NE(cut.line.find("s of a client; the recording is cut off"), std::string::npos)
      << cut.line;
}

}  // namespace

}  // namespace hapticast::evaluate
