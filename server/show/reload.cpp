// SPDX-License-Identifier: MIT
#include "server/show/reload.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

constexpr auto kReloadable = std::to_array<std::string_view>(
    {"damping", "friction", "mass", "quiet", "stiffness", "texture-depth"});

bool isReloadable(const std::string& flag) {
  return std::find(kReloadable.begin(), kReloadable.end(), flag) != kReloadable.end();
}

FlagTexts findFlag(const FlagTexts& flags, const std::string& name) {
  FlagTexts out;
  std::copy_if(flags.begin(), flags.end(), std::back_inserter(out),
               [&name](const auto& flag) { return flag.first == name; });
  return out;
}

std::vector<std::string> objectNames(const VisionSettings& vision) {
  std::vector<std::string> names;
  for (const AuthorObject& object : vision.objects) names.push_back(object.name);
  return names;
}

/// Returns what a scene states besides materials and flags.
Scene removeFlags(Scene scene) {
  scene.flags.clear();
  for (SceneObject& object : scene.objects) object.flags.clear();
  return scene;
}

/// Replaces the values in `running` that `read` may change at once.
void adoptChanges(Settings& running, const Settings& read) {
  std::erase_if(running.flags, [](const auto& flag) { return isReloadable(flag.first); });
  for (const auto& flag : read.flags) {
    if (isReloadable(flag.first)) running.flags.push_back(flag);
  }
  running.quiet = read.quiet;
  running.vision.material = read.vision.material;
  running.vision.mass_kg = read.vision.mass_kg;
  if (objectNames(running.vision) == objectNames(read.vision))
    running.vision.objects = read.vision.objects;
}

}  // namespace

SettingsChange compareSettings(const Settings& running, const Settings& read) {
  SettingsChange change;
  std::set<std::string> names;
  for (const FlagTexts* const flags : {&running.flags, &read.flags}) {
    for (const auto& flag : *flags) names.insert(flag.first);
  }
  for (const std::string& name : names) {
    if (findFlag(running.flags, name) == findFlag(read.flags, name)) continue;
    (isReloadable(name) ? change.now : change.later).push_back("--" + name);
  }
  if (objectNames(running.vision) == objectNames(read.vision) &&
      running.vision.objects != read.vision.objects)
    change.now.emplace_back("materials of the scene's objects");
  const bool scene = !read.vision.scene_file.empty() &&
                     findFlag(running.flags, "scene") == findFlag(read.flags, "scene");
  if (scene && removeFlags(running.scene) != removeFlags(read.scene))
    change.later.emplace_back("--scene (its objects, points or masks)");
  return change;
}

std::optional<VisionSettings> Reloader::reload() {
  if (!read_) return std::nullopt;
  const Result<Settings> read = read_();
  if (!read.ok()) {
    log_.error(read.error().message + "; the settings stay as they are");
    return std::nullopt;
  }
  if (read.value().command != running_.command) {
    log_.error("the configuration asks for another subcommand; start the server again for it");
    return std::nullopt;
  }
  const SettingsChange change = compareSettings(running_, read.value());
  adoptChanges(running_, read.value());
  spdlog::set_level(running_.quiet ? spdlog::level::warn : spdlog::level::info);
  log_.info("configuration read again; changed: " +
            (change.now.empty() ? "nothing" : join(change.now, ", ")));
  if (!change.later.empty())
    log_.warn("these changes take effect at the next start: " + join(change.later, ", "));
  return running_.vision;
}

}  // namespace hapticast::server
