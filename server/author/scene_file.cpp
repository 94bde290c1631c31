// SPDX-License-Identifier: MIT
#include "server/author/scene_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "common/haptic_frame.hpp"
#include "common/text.hpp"
#include "server/author/author_options.hpp"

namespace hapticast::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr int kMostNesting = 8;          // chosen: twice what a scene needs
constexpr std::size_t kMostList = 1000;  // chosen: points or key masks of one object
constexpr std::size_t kMostName_bytes = 64;
constexpr double kMostPixels = 1e5;

constexpr auto kObjectFlags =
    std::to_array<const char*>({"damping", "friction", "mass", "stiffness", "texture-depth"});

[[noreturn]] void refuse(const std::string& what) { throw SceneFileError(what); }

Json parseBounded(std::string_view text) {
  bool too_deep = false;
  const auto bounded = [&](int depth, Json::parse_event_t event, Json&) {
    const bool opens =
        event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    too_deep = too_deep || (opens && depth >= kMostNesting);
    return !too_deep;
  };
  try {
    Json out = Json::parse(text.begin(), text.end(), bounded);
    if (!too_deep && out.is_object()) return out;
  } catch (const Json::parse_error& error) {
    refuse(fmt::format("is no JSON (near byte {})", error.byte));
  } catch (const Json::exception&) {
    refuse("has a number that is too large");
  }
  refuse("is no JSON object with at most 8 levels");
}

/// Returns a value as on the command line: a text, a number, on or off, or a pair "A,B".
std::string toFlagText(const Json& value, const std::string& where) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  const auto is_number = [](const Json& part) { return part.is_number(); };
  if (value.is_array() && value.size() == 2 && std::all_of(value.begin(), value.end(), is_number))
    return value[0].dump() + "," + value[1].dump();
  refuse(where + ": is no text, number, true, false or [A, B]");
}

/// Throws SceneFileError: the member `key` is unknown.
[[noreturn]] void refuseKey(const std::string& where, const std::string& key,
                            std::span<const char* const> flags,
                            std::initializer_list<const char*> others) {
  std::vector<std::string> known(flags.begin(), flags.end());
  known.insert(known.end(), others.begin(), others.end());
  refuse(where + quote(key) + " is not a member of a scene file" + spellingHint(key, known));
}

bool isOneOf(std::span<const char* const> flags, const std::string& key) {
  return std::find(flags.begin(), flags.end(), key) != flags.end();
}

const Json& requireList(const Json& value, const std::string& where) {
  if (value.is_array() && value.size() <= kMostList) return value;
  refuse(fmt::format("{}: is no list with at most {} members", where, kMostList));
}

std::vector<AuthorPoint> parsePoints(const Json& list, const std::string& where) {
  std::vector<AuthorPoint> points;
  for (const Json& each : requireList(list, where)) {
    const std::string text = each.is_string() ? each.get<std::string>() : each.dump();
    const auto point = each.is_string() ? parsePoint(text) : std::nullopt;
    if (!point) refuse(where + ": " + quote(text) + " is not \"U,V\" or \"U,V@SECONDS\" in px");
    points.push_back(*point);
  }
  return points;
}

double requireNumber(const Json& object, const char* key, double least, double most,
                     const std::string& where) {
  const auto value = object.find(key);
  if (value != object.end() && value->is_number()) {
    const double number = value->get<double>();
    if (number >= least && number <= most) return number;
  }
  refuse(fmt::format("{}: \"{}\" is no number from {:g} to {:g}", where, key, least, most));
}

CameraModel parseIntrinsics(const Json& value) {
  const std::string where = "\"camera\"";
  const auto number = [&](const char* key, double least) {
    return requireNumber(value, key, least, kMostPixels, where);
  };
  if (!value.is_object() || value.size() != 4)
    refuse(where + ": is not {\"fx\", \"fy\", \"cx\", \"cy\"} in px");
  return {number("fx", 1.0), number("fy", 1.0), number("cx", -kMostPixels),
          number("cy", -kMostPixels)};
}

std::vector<KeyMaskFile> parseMasks(const Json& list, int number, const std::string& where) {
  std::vector<KeyMaskFile> masks;
  for (const Json& each : requireList(list, where)) {
    const auto file = each.is_object() ? each.find("file") : each.end();
    if (!each.is_object() || each.size() != 2 || file == each.end() || !file->is_string() ||
        file->get<std::string>().empty())
      refuse(where + ": each mask is {\"time\": SECONDS, \"file\": PICTURE}");
    masks.push_back({number, requireNumber(each, "time", 0.0, kLongestClip_s, where),
                     file->get<std::string>()});
  }
  return masks;
}

std::string parseName(const Json& value, const std::string& where) {
  if (value.is_string()) {
    std::string name = value.get<std::string>();
    const bool printable = std::none_of(name.begin(), name.end(),
                                        [](unsigned char c) { return c < 0x20 || c == 0x7F; });
    if (!name.empty() && name.size() <= kMostName_bytes && printable) return name;
  }
  refuse(fmt::format("{}: \"name\" is no text of 1 to {} bytes", where, kMostName_bytes));
}

SceneObject parseObject(const Json& value, int number) {
  std::string where = fmt::format("object {}", number);
  if (!value.is_object()) refuse(where + ": is no JSON object");
  SceneObject object{fmt::format("object {}", number), {}, {}, {}};
  if (value.contains("name")) {
    object.name = parseName(value["name"], where);
    where = "object " + quote(object.name);
  }
  for (const auto& [key, member] : value.items()) {
    if (key == "points") {
      object.points = parsePoints(member, where);
      for (AuthorPoint& point : object.points) point.number = number;
    } else if (key == "masks") {
      object.masks = parseMasks(member, number, where);
    } else if (isOneOf(kObjectFlags, key)) {
      object.flags.emplace_back(key, toFlagText(member, where + ", " + quote(key)));
    } else if (key != "name") {
      refuseKey(where + ": ", key, kObjectFlags, {"name", "points", "masks"});
    }
  }
  if (object.points.empty() && object.masks.empty())
    refuse(where + ": has neither points nor masks; give \"points\": [\"U,V\"]");
  return object;
}

std::vector<SceneObject> parseObjects(const Json& list) {
  if (!list.is_array() || list.size() > kMaxObjects)
    refuse(fmt::format("\"objects\": is no list with at most {} members", kMaxObjects));
  std::vector<SceneObject> objects;
  std::set<std::string> names;
  for (const Json& each : list) {
    objects.push_back(parseObject(each, static_cast<int>(objects.size()) + 1));
    if (!names.insert(objects.back().name).second)
      refuse("object " + quote(objects.back().name) + ": another object has this name");
  }
  return objects;
}

Json formatPoints(const std::vector<AuthorPoint>& points) {
  Json list = Json::array();
  for (const AuthorPoint& point : points) {
    std::string text = fmt::format("{},{}", point.at_px.x(), point.at_px.y());
    if (point.candidate > 1) text += fmt::format("#{}", point.candidate);
    if (point.time_s > 0.0) text += fmt::format("@{}", point.time_s);
    list.push_back(std::move(text));
  }
  return list;
}

Json formatObject(const SceneObject& object) {
  Json out;
  out["name"] = object.name;
  if (!object.points.empty()) out["points"] = formatPoints(object.points);
  for (const KeyMaskFile& mask : object.masks)
    out["masks"].push_back({{"time", mask.time_s}, {"file", mask.file}});
  for (const auto& [name, value] : object.flags) out[name] = value;
  return out;
}

}  // namespace

Scene parseScene(std::string_view text) {
  const Json file = parseBounded(text);
  Scene scene;
  for (const auto& [key, value] : file.items()) {
    if (key == "version") {
      if (value != kVersion) refuse("has another version than 1, which this server cannot read");
    } else if (key == "camera") {
      scene.camera = parseIntrinsics(value);
    } else if (key == "object") {
      scene.object_points = parsePoints(value, "\"object\"");
    } else if (key == "not") {
      scene.not_points = parsePoints(value, "\"not\"");
    } else if (key == "objects") {
      scene.objects = parseObjects(value);
    } else if (isOneOf(kSceneFlags, key)) {
      scene.flags.emplace_back(key, toFlagText(value, quote(key)));
    } else {
      refuseKey("", key, kSceneFlags, {"version", "camera", "object", "not", "objects"});
    }
  }
  const auto is_fov = [](const auto& flag) { return flag.first == "fov"; };
  if (scene.camera && std::any_of(scene.flags.begin(), scene.flags.end(), is_fov))
    refuse("has both \"camera\" and \"fov\"; remove one of them");
  return scene;
}

std::string formatScene(const Scene& scene) {
  Json out;
  out["version"] = kVersion;
  for (const auto& [name, value] : scene.flags) out[name] = value;
  if (scene.camera) {
    const CameraModel& camera = *scene.camera;
    out["camera"] = {
        {"fx", camera.fx_px}, {"fy", camera.fy_px}, {"cx", camera.cx_px}, {"cy", camera.cy_px}};
  }
  if (!scene.object_points.empty()) out["object"] = formatPoints(scene.object_points);
  if (!scene.not_points.empty()) out["not"] = formatPoints(scene.not_points);
  for (const SceneObject& object : scene.objects) out["objects"].push_back(formatObject(object));
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hapticast::server
