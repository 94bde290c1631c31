// SPDX-License-Identifier: MIT
// Recorded runs under the virtual clock: a replay has the bits of the run; damaged recordings end
// with a sentence.
#include "client/recording/replay.hpp"
#include "client/commands/replay_outputs.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "client/desk/run_recorder.hpp"
#include "client/device/profile/device_profile.hpp"
#include "tests/support/drawn_stream.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::client {
namespace {

/// A run with losses, cuts, takeovers, late ticks, lost readings, pauses and re-arming.
class DrawnRun {
 public:
  explicit DrawnRun(std::uint64_t seed) : seed_(seed), random_(seed) {
    settings_.profile = loadDeviceProfile(seed % 3 == 0 ? "falcon" : "omni");
    settings_.method = seed % 4 == 0 ? Method::kThesis : Method::kHapticast;
    settings_.interpolation = seed % 5 == 0 ? Interpolation::kLinear : Interpolation::kHermite;
  }

  /// Returns the reports of all ticks. Writes the recording to `file`.
  std::vector<TickReport> record(const std::string& file) {
    VirtualViewer viewer(settings_, loadDeviceProfile("omni"), Hand{}, nullptr);
    if (seed_ % 2 == 0) viewer.byDatagrams(0.08);
    const auto messages = testing::DrawnStream(seed_).draw(localTime(1.0), 4.0);
    viewer.moveTo(localTime(1.0));
    RunRecorder recorder({file, std::nullopt}, viewer.clock());
    recordFrom(viewer, recorder);
    std::vector<TickReport> reports;
    TickReport last;
    std::size_t next = 0;
    LocalTime now = localTime(1.0);
    while (now < localTime(5.0)) {
      now += draw() < 0.002 ? 35 * kTickPeriod : kTickPeriod;  // a late tick
      for (; next < messages.size() && messages[next].arrival < now; ++next) {
        viewer.moveTo(std::max(viewer.now(), messages[next].arrival));
        (void)viewer.receive(messages[next].bytes);
      }
      viewer.moveTo(now - kTickPeriod);
      changeControls(viewer);
      viewer.nail(last.mapping.toNominal(testing::chooseHand(last, toSeconds(now))), drawStatus());
      if (now > localTime(4.9)) viewer.stop();
      last = viewer.tick();
      recorder.onTick(last);
      reports.push_back(last);
    }
    return reports;
  }

 private:
  static void recordFrom(VirtualViewer& viewer, RunRecorder& recorder) {
    recorder.onSettings(viewer.settings());
    viewer.on_prepared = [&recorder](const PreparedFrame& frame) { recorder.onPrepared(frame); };
    viewer.on_controls = [&recorder](const UserControls& to) { recorder.onControls(to); };
    recorder.attachTo(viewer.receiver());
  }
  double draw() { return std::uniform_real_distribution(0.0, 1.0)(random_); }
  DeviceStatus drawStatus() {
    const double drawn = draw();
    return drawn < 0.002  ? DeviceStatus::kLost
           : drawn < 0.02 ? DeviceStatus::kNoData
                          : DeviceStatus::kOk;
  }
  void changeControls(VirtualViewer& viewer) {
    const double drawn = draw();
    UserControls controls = viewer.controls();
    if (controls.paused ? drawn < 0.01 : drawn < 0.001) {
      controls.paused = !controls.paused;
    } else if (drawn < 0.01) {
      ++controls.rearm;
      controls.stiffness_factor = 0.5 + draw();
      controls.friction = draw();
    } else {
      return;
    }
    viewer.setControls(controls);
  }

  std::uint64_t seed_;
  std::mt19937_64 random_;
  RendererSettings settings_;
};

class ReplayTest : public ::testing::Test {
 protected:
  static std::unique_ptr<Replay> open(const std::string& file) {
    auto opened = Replay::open(file);
    if (!opened.ok()) throw std::runtime_error(opened.error().message);
    return std::move(opened).value();
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

  TempFolder folder_;
};

// Required: 20 recordings, bit-equal.
TEST_F(ReplayTest, HasTheBitsOfTheRun) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const std::string file = path("run" + std::to_string(seed) + ".mcap");
    const std::vector<TickReport> run = DrawnRun(seed).record(file);
    const auto replay = open(file);
    std::size_t next = 0, contacts = 0, different = 0;
    const ReplayCounts counts = replay->run(
        {}, {.onTick = [&](const TickReport& report) {
          ASSERT_LT(next, run.size());
          const TickReport& recorded = run[next++];
          const bool same = hasSameBits(report.force_N, recorded.force_N) &&
                            hasSameBits(report.static_force_N, recorded.static_force_N) &&
                            hasSameBits(report.dynamic_force_N, recorded.dynamic_force_N) &&
                            hasSameBits(report.ahead_mm, recorded.ahead_mm) &&
                            report.play_time == recorded.play_time &&
                            report.safety_actions == recorded.safety_actions &&
                            report.lookup == recorded.lookup && report.fault == recorded.fault;
          different += same ? 0 : 1;
          contacts += report.contact ? 1 : 0;
        }});
    EXPECT_EQ(replay->problem(), "");
    EXPECT_EQ(counts.ticks, run.size());
    EXPECT_EQ(counts.different, 0U);
    EXPECT_EQ(different, 0U);
    EXPECT_GT(contacts, 50U);
  }
}

TEST_F(ReplayTest, ARecordingOfAReplayIsThatOfItsForces) {
  const std::string file = path("run.mcap");
  const std::vector<TickReport> run = DrawnRun(3).record(file);
  ReplayChanges soft;
  soft.stiffness_N_mm = 0.1;
  for (const ReplayChanges& changes : {ReplayChanges{}, soft}) {
    const std::string name = path(changes.any() ? "soft.mcap" : "same.mcap");
    ReplayRecording recording(name);
    const auto first = open(file);
    const ReplayCounts counts = first->run(
        changes,
        {.onTick = [&](const TickReport& report) { recording.onTick(report); },
         .onMessage =
             [&](RunChannel channel, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
               recording.onMessage(channel, time_ns, data);
             }});
    recording.finish();
    EXPECT_EQ(counts.ticks, run.size());
    EXPECT_EQ(counts.different > 0, changes.any());
    const auto again = open(name);
    const ReplayCounts same = again->run({}, {});
    EXPECT_EQ(again->problem(), "");
    EXPECT_EQ(same.ticks, run.size());
    EXPECT_EQ(same.different, 0U);
  }
  EXPECT_THROW(ReplayRecording{file}, RecordingError);
}

TEST_F(ReplayTest, OtherSettingsGiveOtherForcesWithinTheirLimits) {
  const std::string file = path("run.mcap");
  (void)DrawnRun(1).record(file);
  ReplayChanges soft;
  soft.stiffness_N_mm = 0.1;
  ReplayChanges thesis;
  thesis.method = Method::kThesis;
  for (const ReplayChanges& changes : {soft, thesis}) {
    double strongest_N = 0.0;
    const ReplayCounts counts = open(file)->run(changes, {.onTick = [&](const TickReport& report) {
                                                  strongest_N =
                                                      std::max(strongest_N, report.force_N.norm());
                                                }});
    EXPECT_GT(counts.different, 50U);
    EXPECT_GT(counts.largest_difference_N, 0.01);
    EXPECT_LE(strongest_N, loadDeviceProfile("omni").peak_N);
  }
}

TEST_F(ReplayTest, ADamagedRecordingRendersItsBegin) {
  const std::string file = path("run.mcap");
  const std::vector<TickReport> run = DrawnRun(2).record(file);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::mt19937 random(2);
  int scanned = 0;
  for (int i = 0; i < 30; ++i) {
    std::string damaged = bytes.substr(0, bytes.size() - random() % (bytes.size() / 2));
    if (i % 2 == 0) damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    const auto opened =
        Replay::open(folder_.write("damaged.mcap", damaged), [&](double) { ++scanned; });
    if (!opened.ok()) continue;
    const ReplayCounts counts = opened.value()->run({}, {});
    EXPECT_LE(counts.ticks, run.size());
    EXPECT_EQ(counts.different, 0U) << opened.value()->problem();
    if (counts.ticks < run.size()) {
      EXPECT_NE(opened.value()->problem(), "");
    }
  }
  EXPECT_GT(scanned, 30) << "files without a summary";
}

TEST_F(ReplayTest, SettingsKeepTheirBits) {
  RendererSettings settings;
  settings.profile = loadDeviceProfile("falcon");
  settings.profile.mass_kg = 0.1 / 3.0;
  settings.profile.enable_button = 2;
  settings.profile.delay_ticks = 3;
  settings.profile.workspace_mm = {61.0 / 7.0 * 3.0, 60.5, 59.0};
  settings.stiffness_limit_N_mm = 1.0 / 3.0;
  settings.unconfirmed = true;
  const auto decoded = decodeSettings(encodeSettings(settings));
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  const DeviceProfile& profile = decoded.value().profile;
  EXPECT_EQ(profile.mass_kg, settings.profile.mass_kg);
  EXPECT_EQ(profile.workspace_mm, settings.profile.workspace_mm);
  EXPECT_EQ(profile.enable_button, settings.profile.enable_button);
  EXPECT_EQ(profile.delay_ticks, 3);
  EXPECT_EQ(profile.peak_N, 8.0);
  EXPECT_EQ(decoded.value().stiffness_limit_N_mm, settings.stiffness_limit_N_mm);
  EXPECT_TRUE(decoded.value().unconfirmed);
  EXPECT_FALSE(decodeSettings(std::vector<std::uint8_t>{0xFF}).ok());
}

TEST_F(ReplayTest, OtherFilesAreRefused) {
  const auto refuse = [](const std::string& file) {
    const auto opened = Replay::open(file);
    return opened.ok() ? "" : opened.error().message;
  };
  EXPECT_EQ(refuse(path("none.mcap")), "cannot be read (No such file or directory)");
  {
    McapWriter writer(path("other.mcap"), {{"/a", "json", {}}});
    writer.write(0, 1, std::vector<std::uint8_t>{'1'});
  }
  EXPECT_EQ(refuse(path("other.mcap")),
            "has no channel /tick: it is no recording of hapticast-client");
  RendererSettings settings;
  settings.profile = loadDeviceProfile("omni");
  const auto write = [&](const std::string& name, bool has_settings, const RecordedBytes& ticks) {
    McapWriter writer(path(name), listRunChannels());
    if (has_settings) writer.write(kSettingsChannel, 1, encodeSettings(settings));
    writer.write(kTickChannel, 2, ticks);
    return path(name);
  };
  const RecordedBytes one = encodeTicks(std::vector<TickReport>(1)), none = encodeTicks({});
  EXPECT_EQ(refuse(write("begin.mcap", false, one)), "has no settings before its ticks");
  EXPECT_EQ(refuse(write("none.mcap", true, none)), "has no ticks");
  EXPECT_TRUE(refuse(write("wrong.mcap", true, {0xFF}))
                  .starts_with("has no ticks: it has an invalid tick ("));
  EXPECT_EQ(refuse(write("one.mcap", true, one)), "");
}

}  // namespace
}  // namespace hapticast::client
