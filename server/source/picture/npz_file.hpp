// SPDX-License-Identifier: MIT
// Members of NumPy's NPZ files: ZIP archives of arrays, stored or deflated. Members are read as
// streams: no member is in memory as a whole. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "server/source/picture/byte_stream.hpp"

namespace hapticast::server {

/// Returns true if `bytes` begin like a ZIP archive.
[[nodiscard]] bool isZip(std::span<const std::uint8_t> bytes);

/// Return the depth array in an NPZ file: its only array, else the one with the name depths or
/// depth. The stream is an NPY file. If there is no such array, the result has the problem of the
/// file. Requires `bytes` to outlive the stream.
[[nodiscard]] StreamResult openNpz(const std::filesystem::path& file);
[[nodiscard]] StreamResult openNpz(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
