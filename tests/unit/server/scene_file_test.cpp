// SPDX-License-Identifier: MIT
// Scene files: what they set, what wins over them, round trips, and refusals.
#include "server/author/scene_file.hpp"
#include "common/json/json_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "server/settings/command_line.hpp"
#include "tests/unit/command_line_probe.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;
using Probe = testing_support::CommandLineProbe<Settings, commandLine, kSubcommandChoice>;

constexpr const char* kHands = R"({
  "version": 1, "name": "Hands", "map-range": [400, 900.5], "low-latency": true,
  "stiffness": 0.7, "damping": "2", "plan": "smooth=on", "object": ["5,6@3"],
  "camera": {"fx": 300, "fy": 310, "cx": 159.5, "cy": 119.5},
  "not": ["60,150", "61.5,150@1.25"],
  "objects": [
    {"name": "left hand", "points": ["167,111", "170,105@1.5"],
     "stiffness": 0.9, "friction": [0.4, 0.2], "mass": 0.3},
    {"points": ["20,30"], "masks": [{"time": 0.5, "file": "m/two.png"}]}]
})";

Probe runWith(const std::string& scene, std::vector<std::string> more = {}) {
  const TempFolder folder;
  std::vector<std::string> arguments{"--source", "synthetic:still", "--scene",
                                     folder.write("s.json", scene)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return Probe(arguments);
}

TEST(SceneFile, SetsFlagsPointsObjectsAndMasks) {
  const Probe run = runWith(kHands);
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  const VisionSettings& vision = run.settings.vision;
  EXPECT_EQ(run.settings.name, "Hands");
  ASSERT_TRUE(vision.map_range);
  EXPECT_EQ(vision.map_range->far_mm, 900.5);
  EXPECT_TRUE(vision.low_latency);
  EXPECT_EQ(vision.plan.forced[std::size_t(Stage::kSmooth)], true);
  EXPECT_EQ(vision.object_points,
            (std::vector<AuthorPoint>{
                {{167, 111}, 0.0, 1}, {{170, 105}, 1.5, 1}, {{20, 30}, 0.0, 2}, {{5, 6}, 3.0, 0}}));
  EXPECT_EQ(vision.not_points, (std::vector<AuthorPoint>{{{60, 150}, 0.0}, {{61.5, 150}, 1.25}}));
  ASSERT_TRUE(vision.camera);
  EXPECT_EQ(vision.camera->fx_px, 300.0);
  EXPECT_EQ(vision.camera->cx_px, 160.0) << "half a pixel more than in OpenCV's convention";
  ASSERT_EQ(run.settings.key_masks.size(), 1U);
  EXPECT_EQ(run.settings.key_masks[0].number, 2);
  EXPECT_THAT(run.settings.key_masks[0].file, HasSubstr("/m/two.png")) << "beside the scene file";
}

TEST(SceneFile, AnObjectHasItsOwnMaterialAndElseThatOfAllObjects) {
  const VisionSettings vision = runWith(kHands).settings.vision;
  const Material hand = vision.findMaterial(1);
  EXPECT_EQ(hand.stiffness_N_mm, 0.9);
  EXPECT_EQ(hand.damping_Ns_m, 2.0);
  EXPECT_EQ(hand.dynamic_friction, 0.2);
  EXPECT_EQ(hand.mass_kg, 0.3);
  EXPECT_EQ(vision.findMaterial(2).stiffness_N_mm, 0.7);
  EXPECT_EQ(vision.findMaterial(2).mass_kg, std::nullopt);
  EXPECT_EQ(vision.findMaterial(3), vision.material)
      << "an object that the author did not describe";
  EXPECT_EQ(vision.stiffness_N_mm(), 0.9);
}

TEST(SceneFile, FlagsWinAndTheirPointsAddToIt) {
  const Probe run = runWith(kHands, {"--name", "Mine", "--object", "1,2", "--not", "3,4", "--fov",
                                     "60", "--stiffness", "0.2"});
  ASSERT_EQ(run.exit_code, std::nullopt) << run.error;
  const VisionSettings& vision = run.settings.vision;
  EXPECT_EQ(run.settings.name, "Mine");
  EXPECT_EQ(vision.object_points.size(), 5U);
  EXPECT_EQ(vision.object_points.back(), (AuthorPoint{{1, 2}, 0.0}));
  EXPECT_EQ(vision.not_points.size(), 3U);
  EXPECT_FALSE(vision.camera) << "--fov replaces it";
  EXPECT_EQ(vision.findMaterial(2).stiffness_N_mm, 0.2);
  EXPECT_EQ(vision.findMaterial(1).stiffness_N_mm, 0.9) << "the object's own value";
}

TEST(SceneFile, AWrittenSceneHasTheValuesOfTheFlags) {
  const Probe run({"--source", "synthetic:still", "--stiffness", "0.4", "--stretch", "--object",
                   "7,8", "--not", "3,4@2"});
  const Scene& scene = run.settings.scene;
  EXPECT_EQ(scene.flags, (FlagTexts{{"stiffness", "0.4"}, {"stretch", "true"}}));
  EXPECT_EQ(scene.object_points, (std::vector<AuthorPoint>{{{7, 8}, 0.0}}));
  EXPECT_EQ(scene.not_points, (std::vector<AuthorPoint>{{{3, 4}, 2.0}}));
}

TEST(SceneFile, RandomScenesSurviveARoundTrip) {
  std::mt19937 random(11);
  const auto draw = [&random](int most) { return static_cast<int>(random() % unsigned(most + 1)); };
  for (int run = 0; run < 200; ++run) {
    Scene scene;
    const auto points = [&](int least) {
      std::vector<AuthorPoint> out(std::size_t(least + draw(3)));
      for (AuthorPoint& point : out)
        point = {{draw(100'000) / 7.0, draw(9999) / 3.0}, draw(2) * draw(1000) / 9.0};
      return out;
    };
    for (const char* flag : kSceneFlags) {
      if (draw(3) == 0 && std::string_view(flag) != "fov")
        scene.flags.emplace_back(flag, std::to_string(draw(1000)) + "\"\\x\xC3\xBC");
    }
    if (draw(1) == 1) scene.camera = CameraModel{300.0 + draw(9), 301.25, 160.5, 120.0};
    scene.object_points = points(0);
    scene.not_points = points(0);
    for (int number = 1; number <= draw(16); ++number) {
      SceneObject object{"object " + std::to_string(number), points(1), {}, {}};
      for (AuthorPoint& point : object.points) point.number = number;
      for (int i = draw(3); i > 0; --i) object.masks.push_back({number, draw(99) / 8.0, "a b.png"});
      if (draw(1) == 1) object.flags = {{"mass", "1"}};
      scene.objects.push_back(object);
    }
    EXPECT_EQ(parseScene(formatScene(scene)), scene) << formatScene(scene);
  }
}

TEST(SceneFile, RefusesWithFileAndPlace) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "is no JSON"},
      {"{\"name\": \"x\"", "is no JSON"},
      {"[1]", "is no JSON object"},
      {"{\"a\":[[[[[[[[[[1]]]]]]]]]]}", "more than 8 levels"},
      {R"({"fps": 1e999})", "has a number that is too large"},
      {R"({"version": 2})", "another version than 1"},
      {R"({"stifness": 1})", "did you mean stiffness?"},
      {R"({"source": "x"})", "'source' is not a member of a scene file"},
      {R"({"preview": "x"})", "'preview' is not a member of a scene file"},
      {R"({"stiffness": "9x"})", "'9x' is not a number from 0.01 to 10"},
      {R"({"stiffness": {}})", "is no text, number, true, false or [A, B]"},
      {R"({"stretch": "maybe"})", "'maybe' is not true or false"},
      {R"({"map-range": [900, 400]})", "NEAR,FAR in mm"},
      {R"({"not": "3,4"})", "is no list"},
      {R"({"not": ["3"]})", "'not' has '3', which is not"},
      {R"({"camera": {"fx": 1}})", "'fy' is missing"},
      {R"({"camera": {"fx": 0, "fy": 1, "cx": 1, "cy": 1}})", "'fx' is no number from 1"},
      {R"({"fov": 50, "camera": {"fx": 9, "fy": 9, "cx": 1, "cy": 1}})", "exclude each other"},
      {R"({"objects": {}})", "is no list with at most 16 members"},
      {R"({"objects": [3]})", "is no JSON object"},
      {R"({"objects": [{"name": "cup"}]})", "object 'cup' has neither points nor masks"},
      {R"({"objects": [{"name": ""}]})", "no text of 1 to 64 bytes"},
      {R"({"objects": [{"name": "a\nb"}]})", "has a line feed"},
      {R"({"objects": [{"points": ["1,2"], "plan": "auto"}]})", "'plan' is not a member"},
      {R"({"objects": [{"points": ["1,2"], "mass": "1e9"}]})", "object 1': --mass"},
      {R"({"objects": [{"points": ["1,2"], "name": "a"}, {"points": ["3,4"], "name": "a"}]})",
       "another object has the name 'a'"},
      {R"({"objects": [{"masks": [{"time": -1, "file": "a"}]}]})", "'time' is no number from 0"},
      {R"({"objects": [{"masks": ["a.png"]}]})", "is no JSON object"},
  };
  for (const auto& [text, why] : wrong) {
    const Probe run = runWith(text);
    EXPECT_EQ(run.exit_code, 2) << text;
    run.expectErrorWith({"s.json:1:", why});
  }
  const Probe missing({"--source", "synthetic:still", "--scene", "/nowhere/s.json"});
  EXPECT_EQ(missing.exit_code, 2);
  missing.expectErrorWith({"--scene /nowhere/s.json: cannot be read"});
}

// Editors check scene files against the schema, so it must have all members and no others.
TEST(SceneFile, TheSchemaHasEachMember) {
  std::ifstream file(HAPTICAST_TESTS "/../server/author/scene.schema.json");
  const nlohmann::json schema = nlohmann::json::parse(file);
  const nlohmann::json& members = schema["properties"];
  for (const char* flag : kSceneFlags) EXPECT_TRUE(members.contains(flag)) << flag;
  for (const auto& [name, member] : members.items()) {
    try {
      (void)parseScene("{\"" + name + "\": null}");
    } catch (const JsonError& error) {
      EXPECT_EQ(std::string(error.what()).find("is not a member"), std::string::npos) << name;
    }
  }
  EXPECT_EQ(members.size(), kSceneFlags.size() + 5U) << "version, camera, object, not, objects";
}

}  // namespace
}  // namespace hapticast::server
