// SPDX-License-Identifier: MIT
#include "client/device/inverse3/protocol.hpp"

#include <nlohmann/json.hpp>

namespace hapticast::client {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostDevices = 16;

/// Returns the member `key`, or null if `from` is no object or has none.
const Json& findMember(const Json& from, const char* key) {
  static const Json kNone;
  const auto found = from.is_object() ? from.find(key) : from.end();
  return from.is_object() && found != from.end() ? *found : kNone;
}

std::string readText(const Json& from) {
  return from.is_string() ? from.get<std::string>() : std::string();
}

std::optional<double> readNumber(const Json& from) {
  return from.is_number() ? std::optional<double>(from.get<double>()) : std::nullopt;
}

std::optional<Vec3> readPosition_mm(const Json& from) {
  const auto x = readNumber(findMember(from, "x"));
  const auto y = readNumber(findMember(from, "y"));
  const auto z = readNumber(findMember(from, "z"));
  if (!x || !y || !z) return std::nullopt;
  return Vec3(1e3 * *x, 1e3 * *z, -1e3 * *y);
}

bool isFiltered(const Json& config) {
  const Json& filters = findMember(config, "filters");
  return readNumber(findMember(findMember(filters, "force_gate"), "gain")).value_or(0.0) != 0.0 ||
         readNumber(findMember(findMember(filters, "damping"), "scalar")).value_or(0.0) != 0.0;
}

Inverse3Device readDevice(const Json& from) {
  const Json& state = findMember(from, "state");
  const Json& config = findMember(from, "config");
  const Json& calibrated = findMember(findMember(from, "status"), "calibrated");
  return {.id = readText(findMember(from, "device_id")),
          .type = readText(findMember(config, "type")),
          .position_mm = readPosition_mm(findMember(state, "cursor_position")),
          .calibrated = !calibrated.is_boolean() || calibrated.get<bool>(),
          .filtered = isFiltered(config)};
}

std::uint32_t readButtons(const Json& message) {
  std::uint32_t buttons = 0;
  for (const char* grips : {"verse_grip", "wireless_verse_grip"}) {
    const Json& list = findMember(message, grips);
    if (!list.is_array() || list.empty()) continue;
    const Json& pressed = findMember(findMember(list.front(), "state"), "buttons");
    unsigned bit = 0;
    for (const char* name : {"a", "b", "c"}) {
      const Json& each = findMember(pressed, name);
      if (each.is_boolean() && each.get<bool>()) buttons |= 1U << bit;
      ++bit;
    }
  }
  return buttons;
}

Json toDevices(const std::string& id, const char* key, Json value) {
  return {{"inverse3", Json::array({{{"device_id", id}, {key, std::move(value)}}})}};
}

}  // namespace

std::optional<Inverse3Message> parseInverse3(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  Inverse3Message message;
  const Json& devices = findMember(json, "inverse3");
  for (std::size_t i = 0; devices.is_array() && i < std::min(devices.size(), kMostDevices); ++i)
    message.devices.push_back(readDevice(devices[i]));
  message.buttons = readButtons(json);
  message.version = readText(findMember(json, "version"));
  message.has_session =
      findMember(json, "session_id").is_primitive() && !findMember(json, "session_id").is_null();
  return message;
}

Inverse3ForceKey selectForceKey(const Inverse3Message& message) {
  const bool old = message.version.empty() ? !message.has_session
                                           : message.version.starts_with("3.") &&
                                                 std::atoi(message.version.c_str() + 2) < 5;
  return old ? Inverse3ForceKey::kValues : Inverse3ForceKey::kVector;
}

std::string toSessionMessage(const std::string& id, const std::string& preset) {
  Json message =
      toDevices(id, "configure", {{"preset", preset}, {"basis", {{"permutation", "XYZ"}}}});
  message["session"] = {{"configure", {{"profile", {{"name", "org.hapticast:viewer"}}}}}};
  return message.dump();
}

std::string toForceMessage(const std::string& id, Inverse3ForceKey key, const Vec3& force_N) {
  const Json force{{"x", force_N.x()}, {"y", -force_N.z()}, {"z", force_N.y()}};
  const char* const name = key == Inverse3ForceKey::kVector ? "vector" : "values";
  return toDevices(id, "commands", {{"set_cursor_force", {{name, force}}}}).dump();
}

}  // namespace hapticast::client
