// SPDX-License-Identifier: MIT
// Boot loader of the Falcon: brings an opened device to run mode. Its firmware is in volatile
// memory, so after each power-up it has to be loaded from a file of the user.
// Thread: one at a time; blocks.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/device/falcon/usb.hpp"

namespace hapticast::client {

/// Reads the firmware image `file`. Throws std::runtime_error (one line with flag and file).
std::vector<std::uint8_t> readFalconFirmware(const std::string& file);
/// Returns the default file: hapticast/falcon.bin in $XDG_DATA_HOME, else in ~/.local/share. Empty
/// if there is none.
std::string usualFalconFirmware();

/// Returns true if the firmware runs: it answers frames with zero torque. Leaves the chip in run
/// mode. Throws FalconError.
bool falconRuns(FalconUsb& usb, bool event_character);

/// Tries once to load `image`. Calls `progress` with a share of 0..1. Throws FalconError.
void loadFalconFirmware(FalconUsb& usb, const std::vector<std::uint8_t>& image,
                        const std::function<void(double share)>& progress);

}  // namespace hapticast::client
