// SPDX-License-Identifier: MIT
#include "server/source/clip_meta.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/text.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

using Json = nlohmann::json;

// Returns null if the text is no JSON object or exceeds the limits.
Json parseObject(std::string_view text) {
  if (text.size() > kMaxMeta_bytes) return nullptr;
  bool too_deep = false;
  const auto bounded = [&](int depth, Json::parse_event_t event, Json&) {
    const bool opens =
        event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    too_deep = too_deep || (opens && depth >= kMaxMetaDepth);
    return !too_deep;
  };
  Json out = Json::parse(text.begin(), text.end(), bounded, /*allow_exceptions=*/false);
  if (too_deep || !out.is_object()) return nullptr;
  return out;
}

// Returns a value as its author wrote it: a string without quotes, any other value as JSON.
std::string toText(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Range-checked members of one object of the file.
class Members {
 public:
  /// `object` must outlive Members; null has no members. `prefix`: its name in messages.
  Members(const Json& object, const std::string& name, std::string prefix)
      : object_(object), name_(name), prefix_(std::move(prefix)) {}

  /// Returns null if the member is missing.
  [[nodiscard]] const Json& at(const char* key) const {
    static const Json kNone;
    const auto member = object_.find(key);
    return member == object_.end() ? kNone : *member;
  }
  [[nodiscard]] std::optional<double> number(const char* key, double low, double high) const {
    const Json& value = at(key);
    if (value.is_null()) return std::nullopt;
    const std::string text = toText(value);
    const auto number = parseNumber(text);
    if (number && *number >= low && *number <= high) return number;
    throw SourceError(fmt::format("{}: \"{}{}\" is {}, where a number from {} to {} is expected",
                                  name_, prefix_, key, quote(text), low, high));
  }

 private:
  const Json& object_;
  const std::string& name_;
  std::string prefix_;
};

std::optional<int> depthBits(const Members& meta, bool has_scale) {
  if (const auto bits = meta.number("depth_bits", 8.0, 16.0)) return *bits > 8.0 ? 16 : 8;
  const std::string words = toText(meta.at("depth"));
  const auto says = [&](const char* a, const char* b) {
    return words.find(a) != std::string::npos || words.find(b) != std::string::npos;
  };
  if (says("16-bit", "16 bit")) return 16;
  if (says("8-bit", "8 bit")) return 8;
  return has_scale ? std::optional(16) : std::nullopt;
}

std::optional<CameraModel> parseCamera(const Members& intrinsics) {
  const auto fx = intrinsics.number("fx", 1.0, 1e5);
  const auto fy = intrinsics.number("fy", 1.0, 1e5);
  const auto cx = intrinsics.number("cx", -1e5, 1e5);
  const auto cy = intrinsics.number("cy", -1e5, 1e5);
  if (!fx || !fy || !cx || !cy) return std::nullopt;
  return CameraModel{*fx, *fy, *cx + 0.5, *cy + 0.5};
}

}  // namespace

ClipMeta parseClipMeta(std::string_view text, const std::string& name) {
  const Json object = parseObject(text);
  if (object.is_null()) {
    throw SourceError(name +
                      ": is not a JSON object in UTF-8 (of at most 64 KiB); mend or remove it");
  }
  const Members meta(object, name, "");
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
  const Json& intrinsics = meta.at("intrinsics");
  if (intrinsics.is_object()) out.camera = parseCamera({intrinsics, name, "intrinsics."});
  return out;
}

}  // namespace hapticast::server
