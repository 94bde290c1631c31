// SPDX-License-Identifier: MIT
#include "client/device/profile/device_profile.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

#include "tests/support/temp_folder.hpp"
#include "tests/unit/client/complaint.hpp"

namespace hapticast::client {
namespace {

PlantProfile profileOf(const std::string& text) {
  std::istringstream in(text);
  return readDeviceProfile(in, "a file");
}
std::string profileComplaint(const std::string& text) { return complaint(readDeviceProfile, text); }

TEST(DeviceProfileFile, BuiltIn) {
  const PlantProfile omni = loadDeviceProfile("omni");
  EXPECT_EQ(omni.mass_kg, 0.045);
  EXPECT_EQ(omni.stiffness_N_mm, 0.5);
  EXPECT_EQ(omni.delay_ticks, 1);
  const PlantProfile falcon = loadDeviceProfile("falcon");
  EXPECT_EQ(falcon.name, "falcon");
  EXPECT_EQ(falcon.peak_N, 8.0);
  EXPECT_EQ(falcon.count_mm, 0.038);
  EXPECT_EQ(omni.tank_mJ, 15.0);
  EXPECT_EQ(falcon.tank_mJ, 30.0);
  EXPECT_EQ(falcon.tank_W, 0.4);
}

TEST(DeviceProfileFile, EveryFieldByItsName) {
  const PlantProfile p = profileOf(
      "# my own device\nname = bench\r\nmass_kg=0.2\npeak_N = 5\ncontinuous_N = 2\ncount_mm = 0.01 "
      "# fine\n"
      "delay_ticks = 3\n\n  stiffness_N_mm = 1.25\nslew_rise_N_per_tick = "
      "0.3\nslew_fall_N_per_tick = 0.6\n"
      "residue_N_per_tick = 0.2\npulse_limit_N = 1.5\nfriction_N = 0.26\ndamping_Ns_m = 0.4\n"
      "tank_mJ = 7\ntank_W = 0.3\nthermal_s = 30\n"
      "workspace_mm = 100 90  80");
  EXPECT_EQ(p.name, "bench");
  EXPECT_EQ(p.mass_kg, 0.2);
  EXPECT_EQ(p.peak_N, 5.0);
  EXPECT_EQ(p.continuous_N, 2.0);
  EXPECT_EQ(p.count_mm, 0.01);
  EXPECT_EQ(p.delay_ticks, 3);
  EXPECT_EQ(p.stiffness_N_mm, 1.25);
  EXPECT_EQ(p.slew_rise_N_per_tick, 0.3);
  EXPECT_EQ(p.slew_fall_N_per_tick, 0.6);
  EXPECT_EQ(p.residue_N_per_tick, 0.2);
  EXPECT_EQ(p.pulse_limit_N, 1.5);
  EXPECT_EQ(p.friction_N, 0.26);
  EXPECT_EQ(p.damping_Ns_m, 0.4);
  EXPECT_EQ(p.tank_mJ, 7.0);
  EXPECT_EQ(p.tank_W, 0.3);
  EXPECT_EQ(p.thermal_s, 30.0);
  EXPECT_EQ(p.workspace_mm, Vec3(100.0, 90.0, 80.0));
}

TEST(DeviceProfileFile, IsReadFromAFile) {
  const TempFolder folder;
  EXPECT_EQ(loadDeviceProfile(folder.write("device.txt", "mass_kg = 0.3")).mass_kg, 0.3);
}

TEST(DeviceProfileFile, MissingKeysHaveTheValuesOfOmni) {
  const PlantProfile p = profileOf("friction_N = 0.1");
  EXPECT_EQ(p.friction_N, 0.1);
  EXPECT_EQ(p.mass_kg, 0.045);
}

TEST(DeviceProfileFile, ErrorsNameLineKeyAndAllowedValues) {
  EXPECT_EQ(profileComplaint("\nmass_kg = 0"), ":2: mass_kg: '0' is not a number from 0.001 to 10");
  EXPECT_EQ(profileComplaint("mass_kg = heavy"),
            ":1: mass_kg: 'heavy' is not a number from 0.001 to 10");
  EXPECT_EQ(profileComplaint("mass_kg = nan"),
            ":1: mass_kg: 'nan' is not a number from 0.001 to 10");
  EXPECT_EQ(profileComplaint("peak_N = 1e999"),
            ":1: peak_N: '1e999' is not a number from 0.1 to 100");
  EXPECT_EQ(profileComplaint("peak_N = 3 N"), ":1: peak_N: '3 N' is not a number from 0.1 to 100");
  EXPECT_EQ(profileComplaint("peak_N ="), ":1: peak_N: '' is not a number from 0.1 to 100");
  EXPECT_EQ(profileComplaint("delay_ticks = 6"),
            ":1: delay_ticks: '6' is not a number from 0 to 5");
  EXPECT_EQ(profileComplaint("enable_button = 32"),
            ":1: enable_button: '32' is not a number from 0 to 31");
  EXPECT_EQ(profileComplaint("delay_ticks = 1.5"), ":1: delay_ticks: '1.5' is not a whole number");
  EXPECT_EQ(profileComplaint("workspace_mm = 100 90"),
            ":1: workspace_mm: the value must be three numbers: width height depth");
  EXPECT_EQ(profileComplaint("workspace_mm = 100 90 80 70"),
            ":1: workspace_mm: '80 70' is not a number from 10 to 2000");
  EXPECT_EQ(profileComplaint("mass"), ":1: 'mass' is not a `key = value` line");
  EXPECT_EQ(profileComplaint("peak_N = 3\npeak_N = 3"), ":2: peak_N: this key appears twice");
  EXPECT_EQ(profileComplaint("name ="), ":1: name: the value must have 1 to 64 characters");
  EXPECT_EQ(profileComplaint("continuous_N = 5"), ": continuous_N is larger than peak_N");
  EXPECT_EQ(profileComplaint("weight = 3").find(":1: weight: unknown key, allowed are name, "), 0u);
}

TEST(DeviceProfileFile, NonsenseIsRefusedWithoutHarm) {
  EXPECT_EQ(profileComplaint(std::string(70'000, '#')), ": larger than 64 KiB");
  EXPECT_NE(profileComplaint(std::string(60'000, 'x') + "=1"), "accepted");
  EXPECT_NE(profileComplaint(std::string("\0\xff\x80=\0", 5)), "accepted");
  EXPECT_THROW((void)loadDeviceProfile("/nonexistent/profile"), std::runtime_error);
  EXPECT_THROW((void)loadDeviceProfile(::testing::TempDir()), std::runtime_error);  // a folder
}

}  // namespace
}  // namespace hapticast::client
