// SPDX-License-Identifier: MIT
// parseClipMeta(): any text is read or refused with a SourceError, and what is read is in its
// range.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/source/clip_files.hpp"
#include "server/source/rgbd_source.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hapticast::server;
  try {
    const ClipMeta meta = parseClipMeta({reinterpret_cast<const char*>(data), size}, "meta.json");
    if (meta.fps && !(*meta.fps >= 1.0 && *meta.fps <= 240.0)) std::abort();
    if (meta.mm_per_unit && !(*meta.mm_per_unit > 0.0 && *meta.mm_per_unit < 1001.0)) std::abort();
    if (meta.depth_bits && *meta.depth_bits != 8 && *meta.depth_bits != 16) std::abort();
    if (meta.camera && !(meta.camera->fx_px >= 1.0 && meta.camera->fy_px >= 1.0)) std::abort();
  } catch (const SourceError& error) {
    if (std::string_view(error.what()).substr(0, 10) != "meta.json:") std::abort();
  }
  return 0;
}
