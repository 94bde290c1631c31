// SPDX-License-Identifier: MIT
// Check of a device before its first force: the user lets go of the grip and confirms it, then the
// client runs the check of device/check_device.hpp. The client stores the result, so that it checks
// a device with the same profile only once.
// Thread: main.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/desk/user_interface.hpp"
#include "client/device/check_device.hpp"

namespace hapticast::client {

/// Applies the last stored check of `device` to its `profile` (applyCheck()). Returns false if the
/// device has to be checked before its first force: it was never checked with this profile, or it
/// failed. Returns true if it passed, and for a device without a driver (HapticDevice::id()).
bool applyStoredCheck(const HapticDevice& device, DeviceProfile& profile);

/// Stores the result of a check of `device`. Logs what the check found, except for a fault. Throws
/// std::runtime_error (one line) if the file cannot be written.
void storeResult(const HapticDevice& device, const DeviceCheck& check);

/// Throws DeviceAbsent (one line) if no user can confirm the check of `device`: neither `ui` has a
/// window, nor does a user's terminal start the program.
void requireConfirmation(const HapticDevice& device, const UserInterface& ui);

/// Asks the user to let go of the grip, and waits until the user presses Enter in the terminal or
/// in the window. Then runs the check, on a thread of its own. Calls `turn` about every 10 ms: it
/// runs the main loop's part of the device and of `ui`.
///
/// Returns false if `stop` became true. Throws DeviceAbsent (one line) if the device failed, and
/// std::runtime_error (one line) if the device was lost or did not come to rest.
bool runFirstCheck(HapticDevice& device, const Clock& clock, const std::atomic<bool>& stop,
                   UserInterface& ui, const std::function<void()>& turn);

}  // namespace hapticast::client
