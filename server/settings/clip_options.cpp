// SPDX-License-Identifier: MIT
#include "server/settings/clip_options.hpp"

#include <map>
#include <string>

#include "common/cli/options.hpp"
#include "server/author/author_options.hpp"
#include "server/settings/child_options.hpp"
#include "server/settings/scene_option.hpp"

namespace hapticast::server {

namespace {

// Also the heading of these flags in --help.
constexpr const char* kGroup = "The clip and its objects";

const std::map<std::string, Layout> kLayouts{{"separate", Layout::kSeparate},
                                             {"side-by-side", Layout::kSideBySide},
                                             {"top-bottom", Layout::kTopBottom}};
const std::map<std::string, DepthCode> kDepthCodes{
    {"grey", DepthCode::kGrey}, {"inverse", DepthCode::kInverse}, {"hue", DepthCode::kHue}};
const std::map<std::string, DepthCode> kDepthNear{{"bright", DepthCode::kGrey},
                                                  {"dark", DepthCode::kInverse}};

/// Adds the flags about the files, the place, the code and the unit of depth.
void addLayoutOptions(CLI::App& app, VideoLayout& layout) {
  addChoice(
      app, "--layout", layout.layout, kLayouts,
      "The place of the depth in a single video file: a track of its own (separate), or a half "
      "of the picture. Colour is on the left or at the top; with --depth-code hue it is on the "
      "right or below. Default: separate");
  CLI::Option* const code =
      addChoice(app, "--depth-code", layout.code, kDepthCodes,
                "Depth with 8 bits: grey (near is bright), inverse (as --depth-near dark), or, in "
                "videos, hue (Record3D: 3 m for the whole circle of hues). Default: grey");
  addChoice(app, "--depth-near", layout.code, kDepthNear,
            "Where grey depth with 8 bits is near, in folders and videos. Default: bright")
      ->default_str("")  // a configuration file with all defaults would have both
      ->excludes(code);
  addNumber(app, "--depth-unit", layout.depth_unit_mm, 1e-3, 1e4, "MM",
            "mm of one unit of depth, in folders, videos, recordings and v4l2: 0.2 for TUM and "
            "ORB-SLAM (1/5000 m), 1 for mm, 1000 for metres. Default: as the source states, else 1 "
            "for integers and 1000 for floats");
  app.add_option("--color", layout.color_glob,
                 "The colour images of a folder, as a pattern relative to it, e.g. 'frame_*.jpg'; "
                 "needs --depth or --depth-from. Default: the server recognises the layout")
      ->type_name("GLOB");
  app.add_option("--depth", layout.depth_glob,
                 "The depth images of a folder, as a pattern relative to it, e.g. 'depth_*.png'")
      ->type_name("GLOB");
  app.add_option("--topics", layout.topics,
                 "The topics of colour and depth in a recording of ROS 2 or Foxglove (MCAP), e.g. "
                 "/camera/color/image_raw,/camera/depth/image_raw. Default: the only ones")
      ->type_name("COLOR,DEPTH");
}

void addExplain(CLI::App& app, bool& explain) {
  app.add_flag("--explain", explain,
               "Log the stages that the server leaves out for each object, with reason, saving "
               "and cost. Log the candidates for the first mask, with their scores");
}

}  // namespace

void addClipOptions(CLI::App& app, Settings& settings) {
  const std::string before = app.option_defaults()->get_group();
  app.option_defaults()->group(kGroup);
  addNumber(app, "--fps", settings.fps, 1.0, 240.0, "1..240",
            "Frames a second; default: the source's own");
  addLayoutOptions(app, settings.layout);
  addChildOptions(app, settings.child);
  app.add_flag("--to-and-fro", settings.to_and_fro,
               "Play the images of a folder forwards, then backwards; with --loop no jump remains");
  addVisionOptions(app, settings.vision);
  addMaterialOptions(app, settings.vision.material, settings.vision.mass_kg);
  addScene(app, settings);
  addExplain(app, settings.vision.explain);
  app.option_defaults()->group(before);
}

void finishClip(CLI::App& app, Settings& settings) {
  applyScene(app, settings);
  requireChildFlags(app, settings);
}

void refuseClipOptions(const CLI::App& app) {
  for (const CLI::Option* const option : app.get_options()) {
    if (option->get_group() == kGroup && option->count() > 0)
      throw CLI::ValidationError(option->get_name(),
                                 "a recording has its frames already; give this flag to the "
                                 "server that records");
  }
}

}  // namespace hapticast::server
