// SPDX-License-Identifier: MIT
#include "client/haptics/flight_recorder.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <sstream>

#include "client/log.hpp"

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
  fault.force_N = {0.0, 0.25, 1.0};
  fault.penetration_mm = 2.5;
  fault.lookup = Lookup::kExtrapolated;
  recorder->record(fault);
  std::ostringstream out;
  dumpRecorder(out, *recorder);
  EXPECT_EQ(out.str(),
            "t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,sy_N,sz_N,dx_N,dy_N,dz_N,"
            "penetration_mm,lookup\n"
            "0.001000,0.000000,0,0,0,0,0,0,0,0,0,0,0,0,0,none\n"
            "0.002000,-0.250000,1.5,-2,3,0,0.25,1,0,0,0,0,0,0,2.5,extrapolated\n");
  EXPECT_FALSE(recorder->frozen());
  EXPECT_EQ(recorder->size(), 0u);
  recorder->record(fault);
  EXPECT_EQ(recorder->size(), 1u);
  EXPECT_TRUE(recorder->frozen());
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
