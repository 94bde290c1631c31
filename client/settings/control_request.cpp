// SPDX-License-Identifier: MIT
#include "client/settings/control_request.hpp"

#include <array>
#include <string_view>

#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::client {

namespace {

struct MaterialName {
  std::string_view name;
  std::optional<double> Material::*field;
  double least;
  double most;
};
// The limits are those of the server's flags of the same names.
constexpr std::array<MaterialName, 4> kMaterialNames{
    {{"stiffness", &Material::stiffness_N_mm, 0.01, 10.0},
     {"damping", &Material::damping_Ns_m, 0.0, 1000.0},
     {"texture-depth", &Material::texture_K_mm, 0.0, 1000.0},
     {"mass", &Material::mass_kg, 0.001, 100.0}}};

bool parseFriction(std::string_view value, Material& material) {
  const std::size_t colon = value.find(':');
  if (colon == std::string_view::npos) return false;
  const auto most = parseNumberInRange<double>(value.substr(0, colon), 0.0, limits::kFriction);
  const auto sliding = parseNumberInRange<double>(value.substr(colon + 1), 0.0, limits::kFriction);
  if (!most || !sliding || *sliding > *most) return false;
  material.static_friction = most;
  material.dynamic_friction = sliding;
  return true;
}

bool parseItem(std::string_view item, Control& control) {
  if (item == "pause" || item == "play") {
    control.paused = item == "pause";
    return true;
  }
  const std::size_t equals = item.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view name = item.substr(0, equals);
  const std::string_view value = item.substr(equals + 1);
  if (name == "friction") return parseFriction(value, control.material);
  if (name == "seek") {
    control.seek_s = parseNumberInRange<double>(value, 0.0, limits::kClip_s);
    return control.seek_s.has_value();
  }
  if (name == "speed") {
    control.speed = parseNumberInRange<double>(value, limits::kLeastSpeed, limits::kMostSpeed);
    return control.speed.has_value();
  }
  for (const MaterialName& known : kMaterialNames) {
    if (known.name != name) continue;
    const auto number = parseNumberInRange<double>(value, known.least, known.most);
    control.material.*known.field = number;
    return number.has_value();
  }
  return false;
}

}  // namespace

std::optional<Control> parseControl(const std::string& text) {
  Control control;
  std::string_view rest = text;
  while (true) {
    if (!parseItem(rest.substr(0, rest.find(',')), control)) return std::nullopt;
    if (rest.find(',') == std::string_view::npos) return control;
    rest.remove_prefix(rest.find(',') + 1);
  }
}

}  // namespace hapticast::client
