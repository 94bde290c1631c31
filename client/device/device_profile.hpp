// SPDX-License-Identifier: MIT
// Device profiles: built in, or read from a file of `key = value` lines. Before the loop; may
// allocate and throw.
#pragma once

#include <istream>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// A profile and what only a simulation knows of the device: its losses on every axis.
struct PlantProfile : DeviceProfile {
  double friction_N = 0.0;    ///< Coulomb friction
  double damping_Ns_m = 0.1;  ///< physical damping; the least that is said of an Omni
};

/// `omni`, `falcon`, or the name of a file. In the file every field of PlantProfile may stand by
/// its name, `#` begins a comment, workspace_mm is three numbers; what is not said is as in `omni`.
/// Throws std::runtime_error with one line that names file, line, key and what is allowed.
PlantProfile loadDeviceProfile(const std::string& name_or_file);
/// The text of such a file; `file` only names it in complaints.
PlantProfile readDeviceProfile(std::istream& in, const std::string& file);

}  // namespace hapticast::client
