// SPDX-License-Identifier: MIT
// Device profiles: built in, or read from a file of `key = value` lines.
// Thread: any, before the loop; may allocate and throw.
#pragma once

#include <istream>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// A profile, and the losses of the simulated device on every axis.
struct PlantProfile : DeviceProfile {
  double friction_N = 0.0;    ///< Coulomb friction
  double damping_Ns_m = 0.1;  ///< physical damping; default: the lowest published value of an Omni
};

/// Returns the profile `omni` or `falcon`, or that of a file. A file may set every field of
/// PlantProfile by its name. workspace_mm has three numbers, and `#` begins a comment. Missing
/// fields have the values of `omni`. Throws std::runtime_error with one line: file, line, key and
/// the allowed values.
PlantProfile loadDeviceProfile(const std::string& name_or_file);
/// Parses the text of such a file. `file` is its name for error messages. Throws like
/// loadDeviceProfile().
PlantProfile readDeviceProfile(std::istream& in, const std::string& file);

}  // namespace hapticast::client
