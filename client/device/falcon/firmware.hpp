// SPDX-License-Identifier: MIT
// Brings an opened Falcon to run mode. Its firmware is in volatile memory: after each power-up it
// is loaded from a file of the user's.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/device/falcon/usb.hpp"

namespace hapticast::client {

/// The bytes of `file`. Throws std::runtime_error, one line that names the flag and the file.
std::vector<std::uint8_t> readFalconFirmware(const std::string& file);
/// Where it is looked for without a flag: hapticast/falcon.bin in $XDG_DATA_HOME, else in
/// ~/.local/share; empty where there is none.
std::string usualFalconFirmware();

/// Whether the firmware runs: frames with zero torque are answered. Leaves the chip in run mode.
/// Throws FalconError.
bool falconRuns(FalconUsb& usb, bool event_character);

/// One try to load it. `progress` gets a share of 1 now and then. Throws FalconError.
void loadFalconFirmware(FalconUsb& usb, const std::vector<std::uint8_t>& image,
                        const std::function<void(double share)>& progress);

}  // namespace hapticast::client
