// SPDX-License-Identifier: MIT
// Firmware of the Falcon: loads it into an opened device by the device's boot loader. The device
// stores its firmware in volatile memory. So after each power-up the firmware must be loaded again,
// from a file that the user has.
// Thread: one at a time; blocks.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/device/falcon/usb.hpp"

namespace hapticast::client {

/// Returns the bytes of the firmware image `file`. Throws std::runtime_error (one line with flag
/// and file).
std::vector<std::uint8_t> readFalconFirmware(const std::string& file);
/// Returns the name of the default file: hapticast/falcon.bin in $XDG_DATA_HOME, else in
/// ~/.local/share. Returns an empty text if there is no such file.
std::string usualFalconFirmware();

/// Sets up the serial chip for the running firmware, then sends a request that commands zero
/// torque, again and again for at most `patience`. Returns true if the firmware answers, because it
/// then runs. If `event_character` is
/// true, the chip passes a reply on at the reply's last character, without a delay. Throws
/// FalconError.
bool falconRuns(FalconUsb& usb, bool event_character, Duration patience);

/// Loads the firmware `image` into the device, in a single attempt. Calls `progress` with the
/// loaded share, 0..1. Throws FalconError if the attempt fails.
void loadFalconFirmware(FalconUsb& usb, const std::vector<std::uint8_t>& image,
                        const std::function<void(double share)>& progress);

}  // namespace hapticast::client
