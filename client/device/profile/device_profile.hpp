// SPDX-License-Identifier: MIT
// Device profiles: the constants of a device class. A profile is built in, or it is a file of lines
// `key = value`.
// Thread: any, before the loop; the functions may allocate and throw.
#pragma once

#include <istream>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// A device profile, with the friction and damping of the simulated device on every axis.
struct PlantProfile : DeviceProfile {
  double friction_N = 0.0;  ///< Coulomb friction
  /// Physical damping; the default is the lowest published value of an Omni.
  double damping_Ns_m = 0.1;
};

/// Returns a device profile. `name_or_file` is the name of a built-in profile (`omni` or `falcon`),
/// or the name of a file. A file may set every member of PlantProfile by its name. workspace_mm has
/// three numbers, and `#` begins a comment. Missing members have the values of `omni`. Throws
/// std::runtime_error with one line: file, line, key and the allowed values.
PlantProfile loadDeviceProfile(const std::string& name_or_file);
/// Reads a profile from the text of a profile file. `file` is the file's name for error messages.
/// Throws like loadDeviceProfile().
PlantProfile readDeviceProfile(std::istream& in, const std::string& file);

/// Returns the text of a profile file from which readDeviceProfile() reads the same bits.
std::string formatDeviceProfile(const DeviceProfile& profile);

}  // namespace hapticast::client
