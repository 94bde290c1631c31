// SPDX-License-Identifier: MIT
// Opens hapticast-media.so (media_module.hpp) at run time.
// Thread: any, but not the haptic loop (waits for the disk).
#pragma once

#include <string>

#include "common/media/media_module.hpp"

namespace hapticast {

/// Opens hapticast-media.so, which is in the folder of the running program or in
/// /usr/lib/hapticast. The first call takes about 0.1 s. Returns the module, which stays open until
/// the end of the program. Throws std::runtime_error (one line with the file and the remedy) if the
/// file is missing, cannot be opened, or belongs to another version.
[[nodiscard]] const MediaModule& loadMediaModule();

/// Opens the module `file`. Returns and throws like loadMediaModule().
[[nodiscard]] const MediaModule& loadMediaModule(const std::string& file);

}  // namespace hapticast
