// SPDX-License-Identifier: MIT
#include "server/source/folder/clip_meta.hpp"

#include "common/json/json_document.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostLevels = 32;  // chosen: programs of others write what they like

std::optional<int> depthBits(JsonObject& meta, bool has_scale) {
  if (const auto bits = meta.number("depth_bits", 8.0, 16.0)) return *bits > 8.0 ? 16 : 8;
  const auto* const depth = meta.read("depth");
  const std::string words = depth != nullptr ? jsonText(*depth) : "";
  const auto says = [&](const char* a, const char* b) {
    return words.find(a) != std::string::npos || words.find(b) != std::string::npos;
  };
  if (says("16-bit", "16 bit")) return 16;
  if (says("8-bit", "8 bit")) return 8;
  return has_scale ? std::optional(16) : std::nullopt;
}

std::optional<CameraModel> parseCamera(JsonObject intrinsics) {
  const auto fx = intrinsics.number("fx", 1.0, 1e5);
  const auto fy = intrinsics.number("fy", 1.0, 1e5);
  const auto cx = intrinsics.number("cx", -1e5, 1e5);
  const auto cy = intrinsics.number("cy", -1e5, 1e5);
  if (!fx || !fy || !cx || !cy) return std::nullopt;
  return CameraModel{*fx, *fy, *cx + 0.5, *cy + 0.5};
}

ClipMeta readMeta(JsonObject meta) {
  ClipMeta out;
  out.fps = meta.number("fps", 1.0, 240.0);
  if (const auto scale = meta.number("depth_scale_m_per_unit", 1e-6, 1.0))
    out.mm_per_unit = 1000.0 * *scale;
  out.depth_bits = depthBits(meta, out.mm_per_unit.has_value());
  out.fov_deg = meta.number("fov_deg", 10.0, 170.0);
  const auto side_px = [&meta](const char* key) -> std::optional<int> {
    const auto side = meta.number(key, 1.0, 1e5);
    return side ? std::optional(static_cast<int>(*side)) : std::nullopt;
  };
  out.width_px = side_px("width");
  out.height_px = side_px("height");
  const auto* const intrinsics = meta.read("intrinsics");
  if (intrinsics != nullptr && intrinsics->is_object())
    out.camera = parseCamera(meta.object("intrinsics"));
  return out;
}

}  // namespace

ClipMeta parseClipMeta(std::string_view text, const std::string& name) {
  try {
    const JsonDocument document = parseJson(text, {kMaxMeta_bytes, kMostLevels});
    return readMeta(JsonObject(document));
  } catch (const JsonError& error) {
    throw SourceError(describe(name, error) + "; mend or remove the file");
  }
}

}  // namespace hapticast::server
