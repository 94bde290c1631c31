// SPDX-License-Identifier: MIT
// Check of a device (--check-device) with its user: a driver can render another force than the
// commanded one, and only the motion shows that. The check pushes with 0.3 N for 0.1 s along each
// axis, both ways, while a hand holds the grip loosely. The motion has to follow in sign, axis and
// rough size. Half of the difference between the two ways cancels the drift of the hand.
// Thread: one, which runs the ticks of the device.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Result of a check.
struct DeviceCheck {
  /// Column i is the motion in mm after a push along axis i.
  Eigen::Matrix3d response_mm = Eigen::Matrix3d::Zero();
  std::string fault;  ///< what does not follow; empty: the device passed
};

/// Judges the motion of a check. The motion along the pushed axis has to be 0.2 to 40 mm, and the
/// motion aside smaller than that.
DeviceCheck judgeDevice(const Eigen::Matrix3d& response_mm);

/// Runs the check. `log_line` receives instructions. Returns nullopt if `stop` becomes true. Throws
/// std::runtime_error (one line) if the device is lost, or is not held still within a minute.
std::optional<DeviceCheck> checkDevice(HapticDevice& device, const Clock& clock,
                                       const std::atomic<bool>& stop,
                                       const std::function<void(const std::string&)>& log_line);

/// Stores the result for the device `id` in the file `file`, and replaces an earlier one. Throws
/// std::runtime_error (one line).
void storeCheck(const std::string& file, const std::string& id, const DeviceCheck& check);
/// Returns the fault that storeCheck() stored for the device `id`. Returns an empty text if the
/// device passed, or was not checked.
std::string readCheckFault(const std::string& file, const std::string& id);

}  // namespace hapticast::client
