// SPDX-License-Identifier: MIT
// Checks of a study before its first subject: recordings, limits of the device, space on the disk.
// Thread: main.
#pragma once

#include <filesystem>

#include "client/haptics/haptic_device.hpp"
#include "client/study/study.hpp"
#include "common/json/json_error.hpp"

namespace hapticast::client {

/// Reads all recordings of `study`. Throws JsonError with the line of the first condition whose
/// recording is missing or damaged, or which the device with `profile` cannot render: the stiffness
/// of the condition is above `stiffness_limit_N_mm` (0: three times the profile's stiffness), or
/// the device lowers the mass of the condition.
void requireRenderable(const Study& study, const DeviceProfile& profile,
                       double stiffness_limit_N_mm);

/// Throws std::runtime_error with one line if the results of a subject may not fit on the disk of
/// the folder `out`, which need not exist.
void requireSpace(const Study& study, const std::filesystem::path& out);

}  // namespace hapticast::client
