// SPDX-License-Identifier: MIT
#include "client/device/profile/device_profile.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "client/haptics/safety/wall_law.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {
constexpr std::size_t kLongestName = 64;

/// Omni class. The data sheet states a backdrive friction of 0.26 N. The plant has 0.05 N (chosen),
/// because friction flatters stability.
PlantProfile omni() {
  PlantProfile profile;
  profile.friction_N = 0.05;
  return profile;
}

/// Falcon class. Peak (8 N) and workspace are those of CHAI3D's driver, the count is from the
/// encoder's data sheet. Mass, damping and continuous force are assumed. The rest is the Omni's,
/// scaled by the force.
PlantProfile falcon() {
  PlantProfile profile;
  profile.name = "falcon";
  profile.mass_kg = 0.1;
  profile.peak_N = 8.0;
  profile.continuous_N = 2.5;
  profile.count_mm = 0.038;
  profile.stiffness_N_mm = 1.0;
  profile.slew_rise_N_per_tick = 0.5;
  profile.slew_fall_N_per_tick = 1.25;
  profile.residue_N_per_tick = 0.25;
  profile.pulse_limit_N = 4.0;
  profile.tank_mJ = 30.0;
  profile.tank_W = 0.4;
  profile.damping_Ns_m = 0.5;
  profile.workspace_mm = {60.0, 60.0, 60.0};
  return profile;
}

struct NumberKey {
  const char* name;
  double PlantProfile::*field;
  double least;
  double most;
};
// The ranges keep every ramp shorter than two seconds and every law finite.
constexpr std::array<NumberKey, 14> kNumberKeys = {{
    {"mass_kg", &PlantProfile::mass_kg, 0.001, 10.0},
    {"peak_N", &PlantProfile::peak_N, 0.1, 100.0},
    {"continuous_N", &PlantProfile::continuous_N, 0.01, 100.0},
    {"count_mm", &PlantProfile::count_mm, 0.0001, 1.0},
    {"stiffness_N_mm", &PlantProfile::stiffness_N_mm, 0.01, 10.0},
    {"slew_rise_N_per_tick", &PlantProfile::slew_rise_N_per_tick, 0.01, 10.0},
    {"slew_fall_N_per_tick", &PlantProfile::slew_fall_N_per_tick, 0.01, 10.0},
    {"residue_N_per_tick", &PlantProfile::residue_N_per_tick, 0.01, 10.0},
    {"pulse_limit_N", &PlantProfile::pulse_limit_N, 0.0, 100.0},
    {"tank_mJ", &PlantProfile::tank_mJ, 0.1, 10000.0},
    {"tank_W", &PlantProfile::tank_W, 0.001, 100.0},
    {"thermal_s", &PlantProfile::thermal_s, 0.1, 1000.0},
    {"friction_N", &PlantProfile::friction_N, 0.0, 10.0},
    {"damping_Ns_m", &PlantProfile::damping_Ns_m, 0.0, 100.0},
}};
constexpr int kMostButton = 31;
constexpr double kLeastWorkspace_mm = 10.0;
constexpr double kMostWorkspace_mm = 2000.0;

/// A position in a file, for error messages.
struct Place {
  const std::string& file;
  int line;
  const std::string& key;

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(file + ":" + std::to_string(line) + ": " + key + ": " + what);
  }
};

double number(std::string_view text, double least, double most, const Place& place) {
  const auto value = parseNumber(text);
  if (!value || *value < least || *value > most) {
    std::ostringstream what;
    what << quote(text) << " is not a number from " << least << " to " << most;
    place.fail(what.str());
  }
  return *value;
}

int wholeNumber(std::string_view text, int most, const Place& place) {
  const double value = number(text, 0, most, place);
  if (value != std::floor(value)) place.fail(quote(text) + " is not a whole number");
  return static_cast<int>(value);
}

Vec3 workspace(std::string_view text, const Place& place) {
  Vec3 size_mm;
  for (int i = 0; i < 3; ++i) {
    const auto end = text.find_first_of(" \t");
    if (text.empty() || (i < 2 && end == std::string_view::npos)) {
      place.fail("the value must be three numbers: width height depth");
    }
    const std::string_view word = i < 2 ? text.substr(0, end) : text;
    size_mm[i] = number(word, kLeastWorkspace_mm, kMostWorkspace_mm, place);
    text = i < 2 ? trim(text.substr(end)) : std::string_view{};
  }
  return size_mm;
}

std::string listAllowedKeys() {
  std::string keys = "name, delay_ticks, enable_button, workspace_mm";
  for (const NumberKey& key : kNumberKeys) keys += std::string(", ") + key.name;
  return keys;
}

void assign(PlantProfile& profile, std::string_view value, const Place& place) {
  if (place.key == "name") {
    if (value.empty() || value.size() > kLongestName)
      place.fail("the value must have 1 to 64 characters");
    profile.name = value;
  } else if (place.key == "delay_ticks") {
    profile.delay_ticks = wholeNumber(value, kMostDelay_ticks, place);
  } else if (place.key == "enable_button") {
    profile.enable_button = wholeNumber(value, kMostButton, place);
  } else if (place.key == "workspace_mm") {
    profile.workspace_mm = workspace(value, place);
  } else {
    for (const NumberKey& key : kNumberKeys) {
      if (place.key != key.name) continue;
      profile.*key.field = number(value, key.least, key.most, place);
      return;
    }
    place.fail("unknown key, allowed are " + listAllowedKeys());
  }
}

}  // namespace

PlantProfile readDeviceProfile(std::istream& in, const std::string& file) {
  const auto pairs = readKeyValues(in, file);
  if (!pairs.ok()) throw std::runtime_error(pairs.error().message);
  PlantProfile profile = omni();
  std::set<std::string> seen;
  for (const KeyValue& pair : pairs.value()) {
    const Place place{file, pair.line, pair.key};
    if (!seen.insert(pair.key).second) place.fail("this key appears twice");
    assign(profile, pair.value, place);
  }
  if (profile.continuous_N > profile.peak_N) {
    throw std::runtime_error(file + ": continuous_N is larger than peak_N");
  }
  return profile;
}

std::string formatDeviceProfile(const DeviceProfile& profile) {
  PlantProfile all;
  static_cast<DeviceProfile&>(all) = profile;
  std::ostringstream out;
  out.precision(std::numeric_limits<double>::max_digits10);
  for (const NumberKey& key : kNumberKeys) out << key.name << " = " << all.*key.field << '\n';
  out << "delay_ticks = " << profile.delay_ticks << '\n';
  if (profile.enable_button) out << "enable_button = " << *profile.enable_button << '\n';
  out << "workspace_mm = " << profile.workspace_mm.transpose() << '\n';
  return out.str();
}

PlantProfile loadDeviceProfile(const std::string& name_or_file) {
  if (name_or_file == "omni") return omni();
  if (name_or_file == "falcon") return falcon();
  std::ifstream in(name_or_file, std::ios::binary);
  if (!in) {
    throw std::runtime_error(name_or_file +
                             ": cannot be read as a device profile (allowed are omni, falcon or a "
                             "readable file)" +
                             spellingHint(name_or_file, {"omni", "falcon"}));
  }
  return readDeviceProfile(in, name_or_file);
}

}  // namespace hapticast::client
