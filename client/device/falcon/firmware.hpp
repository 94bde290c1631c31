// SPDX-License-Identifier: MIT
// Loads the firmware of the Falcon into an opened device, through the device's boot loader. The
// device stores its firmware in volatile memory. So after each power-up the firmware must be loaded
// again, from a file that the user provides.
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

/// Checks whether the firmware runs. Sets up the serial chip, and repeats a request for zero torque
/// for at most `patience`. Returns true if the firmware answers. If `event_character` is true, the
/// chip transfers each reply as soon as its last character has arrived, without waiting for its
/// timer. Throws FalconError.
bool falconRuns(FalconUsb& usb, bool event_character, Duration patience);

/// Loads the firmware `image` into the device, in a single attempt. Calls `progress` with the
/// loaded share, 0..1. Throws FalconError if the attempt fails.
void loadFalconFirmware(FalconUsb& usb, const std::vector<std::uint8_t>& image,
                        const std::function<void(double share)>& progress);

}  // namespace hapticast::client
