// SPDX-License-Identifier: MIT
// Device profiles: built in, or read from a file of `key = value` lines. Before the loop; may
// allocate and throw.
#pragma once

#include <istream>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// `omni`, `falcon`, or the name of a file. In the file every field of DeviceProfile may stand by
/// its name, `#` begins a comment, workspace_mm is three numbers; what is not said is as in `omni`.
/// Throws std::runtime_error with one line that names file, line, key and what is allowed.
DeviceProfile loadDeviceProfile(const std::string& name_or_file);
/// The text of such a file; `file` only names it in complaints.
DeviceProfile readDeviceProfile(std::istream& in, const std::string& file);

}  // namespace hapticast::client
