// SPDX-License-Identifier: MIT
#include "client/haptics/flight_recorder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <set>
#include <sstream>

#include "client/report/fault_log.hpp"
#include "client/report/tick_log.hpp"
#include "common/private_file.hpp"

namespace hapticast::client {
namespace {

TickReport numbered(std::uint64_t tick) {
  TickReport report;
  report.tick = tick;
  report.time = LocalTime(Duration(static_cast<std::int64_t>(tick) * 1'000'000));
  return report;
}

TEST(FlightRecorder, KeepsTheLastTicksUpToTheFirstFault) {
  auto recorder = std::make_unique<FlightRecorder>();
  for (std::uint64_t i = 1; i <= 5000; ++i) recorder->record(numbered(i));
  EXPECT_FALSE(recorder->frozen());
  TickReport fault = numbered(5001);
  fault.fault = Fault::kDeviceLost;
  recorder->record(fault);
  EXPECT_TRUE(recorder->frozen());
  for (std::uint64_t i = 5002; i < 9000; ++i) recorder->record(numbered(i));  // not taken
  ASSERT_EQ(recorder->size(), FlightRecorder::kTicks);
  EXPECT_EQ(recorder->at(0).tick, 3002u);
  EXPECT_EQ(recorder->at(1999).tick, 5001u);
  EXPECT_EQ(recorder->at(1999).fault, Fault::kDeviceLost);
}

TEST(FlightRecorder, DumpsRowsAndRecordsAgain) {
  auto recorder = std::make_unique<FlightRecorder>();
  recorder->record(numbered(1));
  TickReport fault = numbered(2);
  fault.fault = Fault::kNotFinite;
  fault.play_time = mediaTime(-0.25);
  fault.hip_mm = {1.5, -2.0, 3.0};
  fault.ahead_mm = {1.5, -2.0, 2.5};
  fault.force_N = {0.0, 0.25, 1.0};
  fault.penetration_mm = 2.5;
  fault.lookup = Lookup::kExtrapolated;
  recorder->record(fault);
  std::ostringstream out;
  dumpRecorder(out, *recorder, localTime(0.001));
  EXPECT_EQ(out.str(),
            "t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,sy_N,sz_N,dx_N,dy_N,dz_N,"
            "penetration_mm,lookup,ahead_x_mm,ahead_y_mm,ahead_z_mm\n"
            "0.000000,0.000000,0,0,0,0,0,0,0,0,0,0,0,0,0,none,0,0,0\n"
            "0.001000,-0.250000,1.5,-2,3,0,0.25,1,0,0,0,0,0,0,2.5,extrapolated,1.5,-2,2.5\n");
  EXPECT_FALSE(recorder->frozen());
  EXPECT_EQ(recorder->size(), 0u);
  recorder->record(fault);
  EXPECT_EQ(recorder->size(), 1u);
  EXPECT_TRUE(recorder->frozen());
}

class FlightRecorderFilesTest : public ::testing::Test {
 protected:
  FlightRecorderFilesTest() { std::filesystem::remove_all(folder_); }
  ~FlightRecorderFilesTest() override { std::filesystem::remove_all(folder_); }
  void fault() {
    TickReport report = numbered(++tick_);
    report.fault = Fault::kDeviceLost;
    recorder_->record(report);
  }
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    if (!std::filesystem::exists(folder_)) return names;
    for (const auto& file : std::filesystem::directory_iterator(folder_))
      names.insert(file.path().filename().string());
    return names;
  }
  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) /
                                  ("hapticast_faults_" + std::to_string(getpid()));
  std::unique_ptr<FlightRecorder> recorder_ = std::make_unique<FlightRecorder>();
  std::uint64_t tick_ = 0;
};

TEST_F(FlightRecorderFilesTest, OfEveryRunStay) {
  for (int run = 0; run < 2; ++run) {
    FaultLogWriter out(folder_ / "made");
    for (int i = 0; i < 2 * FaultLogWriter::kMaxFiles; ++i) {
      fault();
      out.write(*recorder_, localTime(0.0));
    }
    recorder_ = std::make_unique<FlightRecorder>();
  }
  folder_ /= "made";
  const auto names = files();
  EXPECT_EQ(names.size(), 2U * FaultLogWriter::kMaxFiles) << "ten of each run";
  const std::regex form(R"(hapticast-fault-\d{8}T\d{6}Z-\d+\.csv)");
  for (const std::string& name : names) EXPECT_TRUE(std::regex_match(name, form)) << name;
  folder_ = folder_.parent_path();
}

TEST_F(FlightRecorderFilesTest, AFolderThatCannotBeMadeIsReportedAtOnce) {
  std::ofstream(folder_.string()) << "a file";
  try {
    const FaultLogWriter out(folder_ / "below");
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find("--fault-dir " + folder_.string()), 0U)
        << error.what();
  }
}

TEST_F(FlightRecorderFilesTest, WithoutAFlagLieInTheStateFolderAndTheRunGoesOnWithoutOne) {
  std::filesystem::create_directories(folder_);
  ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
  EXPECT_EQ(stateFolder(), folder_ / "hapticast");
  FaultLogWriter out("");
  EXPECT_TRUE(files().empty()) << "made when it is needed";
  fault();
  out.write(*recorder_, localTime(0.0));
  EXPECT_EQ(files(), std::set<std::string>{"hapticast"});
  std::ofstream((folder_ / "file").string()) << "in the way";
  ::setenv("XDG_STATE_HOME", (folder_ / "file").c_str(), 1);
  FaultLogWriter nowhere("");
  fault();
  nowhere.write(*recorder_, localTime(0.0));
  EXPECT_FALSE(recorder_->frozen()) << "it records again";
  ::unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(stateFolder().filename(), "hapticast");
}

TEST(FlightRecorder, ManyDaysKeepTheirMicroseconds) {
  TickReport report;
  report.time = LocalTime(Duration(8'640'000'123'456'789));
  std::ostringstream out;
  writeReport(out, report);
  EXPECT_EQ(out.str().substr(0, out.str().find(',')), "8640000.123456");
}

}  // namespace
}  // namespace hapticast::client
