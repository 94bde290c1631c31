// SPDX-License-Identifier: MIT
// Check of a device (--check-device) with its user. A faulty driver can render another force than
// the commanded one, and only the motion of the grip shows that. While the user holds the grip
// loosely, the check pushes it along each axis with 0.3 N for 0.1 s, once in each direction. The
// measured motion must have the right sign, axis and rough size. Half of the difference between the
// motions of the two pushes is free of the drift of the hand.
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
  /// Column i belongs to axis i: half of the difference between the motions (mm) of the push in the
  /// positive direction and of the push in the negative direction.
  Eigen::Matrix3d response_mm = Eigen::Matrix3d::Zero();
  std::string fault;  ///< the wrong motion, for the user; empty: the device passed
};

/// Compares the motions of a check with the pushes. In each column the motion along the pushed axis
/// must be 0.2 to 40 mm, and the motion across that axis must be smaller.
DeviceCheck judgeDevice(const Eigen::Matrix3d& response_mm);

/// Runs the check. `log_line` receives instructions. Returns nullopt if `stop` becomes true. Throws
/// std::runtime_error (one line) if the device is lost, or if the user does not hold the grip still
/// within a minute.
std::optional<DeviceCheck> checkDevice(HapticDevice& device, const Clock& clock,
                                       const std::atomic<bool>& stop,
                                       const std::function<void(const std::string&)>& log_line);

/// Stores the result for the device `id` in the file `file`, in place of an earlier result. Throws
/// std::runtime_error (one line).
void storeCheck(const std::string& file, const std::string& id, const DeviceCheck& check);
/// Returns the fault that storeCheck() stored for the device `id`. Returns an empty text if the
/// device passed, or was not checked.
std::string readCheckFault(const std::string& file, const std::string& id);

}  // namespace hapticast::client
