// SPDX-License-Identifier: MIT
#include "server/settings/scene_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "common/cli/options.hpp"
#include "common/json/json_document.hpp"
#include "common/private_file.hpp"
#include "server/author/author_options.hpp"

namespace hapticast::server {

namespace {

struct SceneText {
  std::string file;
  std::string text;
};

[[noreturn]] void refuse(const SceneText& scene, const JsonError& error) {
  throw CLI::ParseError("--scene " + describe(scene.file, error), CLI::ExitCodes::ValidationError);
}

/// Gives `text` to the option `name` of `app`, as if the user had typed it.
void setOption(CLI::App& app, const std::string& name, const std::string& text) {
  CLI::Option* const option = app.get_option_no_throw("--" + name);
  if (option == nullptr) throw CLI::ValidationError("--" + name, "has no effect here");
  if (option->count() > 0) return;
  const bool is_switch = option->get_items_expected_max() == 0;
  if (is_switch && text != "true" && text != "false")
    throw CLI::ValidationError("--" + name, quote(text) + " is not true or false");
  option->add_result(text);
  option->run_callback();
}

/// Sets the flags of the object at the JSON pointer `at`. `whose` begins the text of an error.
void applyFlags(CLI::App& app, const SceneText& scene, const FlagTexts& flags,
                const std::string& at, const std::string& whose) {
  for (const auto& [name, text] : flags) {
    try {
      setOption(app, name, text);
    } catch (const CLI::ParseError& error) {
      const JsonPlace place = parseJson(scene.text).places.at(fmt::format("{}/{}", at, name));
      refuse(scene, JsonError(place, whose + error.what()));
    }
  }
}

/// Checks the materials of the objects, and stores them in `settings`.
void addObjects(const SceneText& scene, Settings& settings) {
  for (std::size_t i = 0; i < settings.scene.objects.size(); ++i) {
    const SceneObject& object = settings.scene.objects[i];
    AuthorObject& known = settings.vision.objects.emplace_back();
    known.name = object.name;
    CLI::App flags;
    addMaterialOptions(flags, known.material, known.material.mass_kg);
    applyFlags(flags, scene, object.flags, "/objects/" + std::to_string(i),
               "object " + quote(object.name) + ": ");
  }
}

/// Reads the scene file of --scene, if there is one.
void loadScene(CLI::App& app, Settings& settings) {
  const std::string& file = settings.vision.scene_file;
  if (file.empty()) return;
  const Result<std::string> text = readSmallFile(file);
  if (!text.ok()) throw CLI::ValidationError("--scene " + file, text.error().message);
  const SceneText scene{file, text.value()};
  try {
    settings.scene = parseScene(scene.text);
  } catch (const JsonError& error) {
    refuse(scene, error);
  }
  applyFlags(app, scene, settings.scene.flags, "", "");
  addObjects(scene, settings);
}

/// Fills the values that an object does not state with those of all objects.
void addCommonMaterial(const Material& common, Material& material) {
  const auto fill = [&](auto field) {
    if (!(material.*field)) material.*field = common.*field;
  };
  fill(&Material::stiffness_N_mm);
  fill(&Material::damping_Ns_m);
  fill(&Material::texture_K_mm);
  if (material.static_friction || material.dynamic_friction) return;
  fill(&Material::static_friction);
  fill(&Material::dynamic_friction);
}

}  // namespace

void addScene(CLI::App& app, Settings& settings) {
  CLI::Option* const option = app.add_option(
      "--scene", settings.vision.scene_file,
      "The author's work on the clip (JSON): objects with points, key masks and material, and "
      "flags; other flags win over it, and their points add to it. --preview FOLDER writes one");
  option->type_name("FILE.json");
}

void applyScene(CLI::App& app, Settings& settings) {
  loadScene(app, settings);
  Scene& scene = settings.scene;
  VisionSettings& vision = settings.vision;
  for (AuthorObject& object : vision.objects) addCommonMaterial(vision.material, object.material);
  if (vision.fov_deg) scene.camera.reset();
  if (scene.camera) {
    vision.camera = scene.camera;
    vision.camera->cx_px += 0.5;  // from OpenCV's convention
    vision.camera->cy_px += 0.5;
  }
  const std::filesystem::path folder =
      std::filesystem::path(settings.vision.scene_file).parent_path();
  std::vector<AuthorPoint> points;
  for (const SceneObject& object : scene.objects) {
    points.insert(points.end(), object.points.begin(), object.points.end());
    for (KeyMaskFile mask : object.masks) {
      mask.file = (folder / mask.file).string();
      settings.key_masks.push_back(std::move(mask));
    }
  }
  const auto join = [](std::vector<AuthorPoint> first, const std::vector<AuthorPoint>& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
  };
  scene.object_points = join(scene.object_points, vision.object_points);
  scene.not_points = vision.not_points = join(scene.not_points, vision.not_points);
  vision.object_points = join(points, scene.object_points);
  scene.flags.clear();
  for (const char* name : kSceneFlags) {
    const CLI::Option* const option = app.get_option_no_throw(std::string("--") + name);
    if (option != nullptr && option->count() > 0)
      scene.flags.emplace_back(name, option->results().back());
  }
}

}  // namespace hapticast::server
