// SPDX-License-Identifier: MIT
#include "server/author/scene_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>

#include "common/haptic_frame.hpp"
#include "common/json/json_document.hpp"
#include "common/text.hpp"
#include "server/author/author_options.hpp"

namespace hapticast::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::size_t kMostList = 1000;  // chosen: points or key masks of one object
constexpr std::size_t kMostName_bytes = 64;
constexpr double kMostPixels = 1e5;
constexpr const char* kStranger = "is not a member of a scene file";

constexpr auto kObjectFlags =
    std::to_array<const char*>({"damping", "friction", "mass", "stiffness", "texture-depth"});

/// Returns the member `key` as on the command line: a text, a number, on or off, or a pair "A,B".
std::string toFlagText(const JsonObject& from, const char* key, const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  const auto is_number = [](const nlohmann::json& part) { return part.is_number(); };
  if (value.is_array() && value.size() == 2 && std::all_of(value.begin(), value.end(), is_number))
    return value[0].dump() + "," + value[1].dump();
  from.refuse(key, "is no text, number, true, false or [A, B]");
}

FlagTexts parseFlags(JsonObject& from, std::span<const char* const> names) {
  FlagTexts flags;
  for (const char* const name : names) {
    if (const auto* const value = from.read(name))
      flags.emplace_back(name, toFlagText(from, name, *value));
  }
  return flags;
}

std::vector<AuthorPoint> parsePoints(JsonObject& from, const char* key) {
  std::vector<AuthorPoint> points;
  const auto* const list = from.read(key);
  if (list == nullptr) return points;
  if (!list->is_array() || list->size() > kMostList)
    from.refuse(key, fmt::format("is no list with at most {} members", kMostList));
  for (const auto& each : *list) {
    const std::string text = jsonText(each);
    const auto point = each.is_string() ? parsePoint(text) : std::nullopt;
    if (!point)
      from.refuse(key, "has " + quote(text) + ", which is not \"U,V\" or \"U,V@SECONDS\" in px");
    points.push_back(*point);
  }
  return points;
}

double requireNumber(JsonObject& from, const char* key, double least, double most) {
  const auto number = from.number(key, least, most);
  if (!number) from.refuse(key, fmt::format("is missing: a number from {:g} to {:g}", least, most));
  return *number;
}

CameraModel parseIntrinsics(JsonObject from) {
  const auto number = [&from](const char* key, double least) {
    return requireNumber(from, key, least, kMostPixels);
  };
  const CameraModel camera{number("fx", 1.0), number("fy", 1.0), number("cx", -kMostPixels),
                           number("cy", -kMostPixels)};
  from.refuseOthers("is no member of a camera");
  return camera;
}

std::vector<KeyMaskFile> parseMasks(JsonObject& from, int number) {
  std::vector<KeyMaskFile> masks;
  for (JsonObject& each : from.objects("masks", kMostList)) {
    const auto time_s = each.number("time", 0.0, kLongestClip_s);
    const auto file = each.text("file", 4096);
    if (!time_s || !file || each.value().size() != 2)
      throw JsonError(each.place(), "each mask is {\"time\": SECONDS, \"file\": PICTURE}");
    masks.push_back({number, *time_s, *file});
  }
  return masks;
}

SceneObject parseObject(JsonObject from, int number) {
  SceneObject object{fmt::format("object {}", number), {}, {}, {}};
  if (auto name = from.text("name", kMostName_bytes)) {
    if (name->find('\n') != std::string::npos) from.refuse("name", "has a line feed");
    object.name = *std::move(name);
  }
  object.points = parsePoints(from, "points");
  for (AuthorPoint& point : object.points) point.number = number;
  object.masks = parseMasks(from, number);
  object.flags = parseFlags(from, kObjectFlags);
  from.refuseOthers(kStranger);
  if (object.points.empty() && object.masks.empty())
    throw JsonError(from.place(), "object " + quote(object.name) +
                                      " has neither points nor masks; give \"points\": [\"U,V\"]");
  return object;
}

std::vector<SceneObject> parseObjects(JsonObject& from) {
  std::vector<SceneObject> objects;
  std::set<std::string> names;
  for (JsonObject& each : from.objects("objects", kMaxObjects)) {
    const JsonPlace place = each.place();
    objects.push_back(parseObject(std::move(each), static_cast<int>(objects.size()) + 1));
    if (!names.insert(objects.back().name).second)
      throw JsonError(place, "another object has the name " + quote(objects.back().name));
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
  const JsonDocument document = parseJson(text);
  JsonObject file(document);
  if (const auto* const version = file.read("version"); version != nullptr && *version != kVersion)
    file.refuse("version", "is another version than 1, which this server cannot read");
  Scene scene;
  if (file.read("camera") != nullptr) scene.camera = parseIntrinsics(file.object("camera"));
  scene.object_points = parsePoints(file, "object");
  scene.not_points = parsePoints(file, "not");
  scene.objects = parseObjects(file);
  scene.flags = parseFlags(file, kSceneFlags);
  file.refuseOthers(kStranger);
  if (scene.camera && file.read("fov") != nullptr)
    file.refuse("fov", "and \"camera\" exclude each other; remove one of them");
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
