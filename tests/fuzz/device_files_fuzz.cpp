// SPDX-License-Identifier: MIT
// The files a device is set up with (profile, hand targets): any text is taken or refused with one
// line, and what is taken is safe for the loop.
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>

#include "client/device/profile/device_profile.hpp"
#include "client/device/virtual/hand_script.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::device_files {
namespace {

/// The error of `read` is one line that names the file.
template <class Read>
void readOrRefuse(const std::string& text, Read read) {
  std::istringstream in(text);
  try {
    read(in);
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    require(line.starts_with("f:") && line.find('\n') == std::string::npos);
  }
}

void profile(std::istream& in) {
  const auto profile = hapticast::client::readDeviceProfile(in, "f");
  require(profile.mass_kg >= 0.001 && profile.stiffness_N_mm <= 10.0);
  require(profile.continuous_N <= profile.peak_N && profile.peak_N <= 100.0);
  require(profile.delay_ticks >= 0 && profile.delay_ticks <= 5);
  require(profile.workspace_mm.minCoeff() >= 10.0 && profile.workspace_mm.maxCoeff() <= 2000.0);
}

void hand(std::istream& in) {
  const auto targets = hapticast::client::readHandTargets(in, "f");
  require(!targets.empty());
  double last_s = -1.0;
  for (const auto& target : targets) {
    require(target.t_s > last_s && target.t_s <= 86'400.0);
    require(target.position_mm.cwiseAbs().maxCoeff() <= 1000.0);
    last_s = target.t_s;
  }
}

}  // namespace

HAPTICAST_FUZZ_TARGET("device_files") {
  const std::string text(reinterpret_cast<const char*>(data), size);
  readOrRefuse(text, profile);
  readOrRefuse(text, hand);
  return 0;
}

}  // namespace hapticast::fuzz::device_files
