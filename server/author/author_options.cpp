// SPDX-License-Identifier: MIT
#include "server/author/author_options.hpp"

#include <map>
#include <string_view>
#include <vector>

#include "common/cli/options.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

const std::map<std::string, SegmentMode> kSegmentModes{{"auto", SegmentMode::kAuto},
                                                       {"band", SegmentMode::kBand},
                                                       {"edges", SegmentMode::kEdges},
                                                       {"source", SegmentMode::kSource}};
const std::map<std::string, MotionMode> kMotionModes{{"auto", MotionMode::kAuto},
                                                     {"rgbd", MotionMode::kRgbd},
                                                     {"lk", MotionMode::kLk},
                                                     {"depth", MotionMode::kDepth},
                                                     {"none", MotionMode::kNone}};

const std::map<std::string, Method> kMethods{{"hapticast", Method::kHapticast},
                                             {"thesis", Method::kThesis}};

constexpr double kMostDepth_mm = 1e6;

void addRange(CLI::App& app, const char* flag, std::optional<DepthRange>& range, const char* help) {
  const auto take = [&range](const Vec2& pair) {
    if (!(pair.x() >= 0.0 && pair.x() < pair.y() && pair.y() <= kMostDepth_mm)) return false;
    range = DepthRange{pair.x(), pair.y()};
    return true;
  };
  addPair(app, flag, take, "NEAR,FAR in mm with 0 <= NEAR < FAR <= 1000000", help)
      ->type_name("MM,MM");
}

void addRanges(CLI::App& app, VisionSettings& vision) {
  addRange(
      app, "--depth-range", vision.depth_range,
      "The depths of the levels 255 and 0 of 8-bit depth; for depth in mm the same as --map-range");
  addRange(
      app, "--map-range", vision.map_range,
      "Depths that become the nearest and farthest height; default: the object's, from the clip");
}

constexpr double kMostFriction = limits::kFriction;

void addFriction(CLI::App& app, Material& material) {
  const auto take = [&material](const Vec2& pair) {
    if (!(pair.y() >= 0.0 && pair.y() <= pair.x() && pair.x() <= kMostFriction)) return false;
    material.static_friction = pair.x();
    material.dynamic_friction = pair.y();
    return true;
  };
  addPair(app, "--friction", take, "S,D with 0 <= D <= S <= 1.5",
          "The surface's coefficients of static and dynamic friction; default: each viewer's own");
}

/// Parses `auto`, `everything` or `STAGE=on|off,...`; nullopt for other texts.
std::optional<PlanSettings> parsePlan(std::string_view text) {
  PlanSettings out;
  if (text == "auto") return out;
  if (text == "everything") {
    out.everything = true;
    return out;
  }
  while (true) {
    const std::string_view item = text.substr(0, text.find(','));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const auto* const name =
        std::find(kStageNames.begin(), kStageNames.end(), item.substr(0, equals));
    const std::string_view value = item.substr(equals + 1);
    if (name == kStageNames.end() || (value != "on" && value != "off")) return std::nullopt;
    out.forced[static_cast<std::size_t>(name - kStageNames.begin())] = value == "on";
    if (item.size() == text.size()) return out;
    text.remove_prefix(item.size() + 1);
  }
}

/// Sets the plan, without changing the error budget; the order of both flags does not matter.
void addPlan(CLI::App& app, PlanSettings& plan) {
  const auto set = [&plan](const std::string& text) {
    const std::optional<PlanSettings> parsed = parsePlan(text);
    if (!parsed) {
      const std::vector<std::string> stages(kStageNames.begin(), kStageNames.end());
      throw CLI::ValidationError("--plan",
                                 quote(text) +
                                     " is not auto, everything or STAGE=on|off,... with the "
                                     "stages " +
                                     join(stages, ", "));
    }
    plan.everything = parsed->everything;
    plan.forced = parsed->forced;
  };
  app.add_option_function<std::string>(
         "--plan", set,
         "The stages of the scene plan: auto leaves out the stages that a scene does not need, "
         "everything keeps every stage, and STAGE=on|off sets segment, clean, smooth, motion, grid "
         "or heights")
      ->type_name("auto|everything|STAGE=on|off,...")
      ->default_str("auto");
}

/// As parsePoint(). A point of --not has no candidates.
std::optional<AuthorPoint> parseNotPoint(const std::string& text) {
  return text.find('#') == std::string::npos ? parsePoint(text) : std::nullopt;
}

void addPoints(CLI::App& app, VisionSettings& vision) {
  addList(app, "--object", vision.object_points, parsePoint,
          "A pixel on the object to touch, in the first frame or SECONDS after it; repeat for "
          "several. #2 or #3 picks another candidate for the first mask (--preview FOLDER shows "
          "them). Default: the nearest compact object",
          "U,V[#N|@SECONDS] in px, for example 505,330 or 505,330@1.5");
  addList(app, "--not", vision.not_points, parseNotPoint,
          "A pixel that does not belong to the object, in the first frame or SECONDS after it; "
          "repeat for several",
          "U,V[@SECONDS] in px, for example 300,400 or 300,400@1.5");
}

}  // namespace

std::optional<AuthorPoint> parsePoint(const std::string& text) {
  const std::size_t at = text.find('@');
  const std::size_t pick = std::min(text.find('#'), at);
  const auto place_px = parsePair(text.substr(0, pick));
  if (!place_px) return std::nullopt;
  if (pick < at) {  // of the first frame
    constexpr std::uint64_t kMost = kMostCandidates;
    const auto candidate = parseNumberInRange<std::uint64_t>(text.substr(pick + 1), 1, kMost);
    if (!candidate) return std::nullopt;
    return AuthorPoint{*place_px, 0.0, 0, static_cast<int>(*candidate)};
  }
  if (at == std::string::npos) return AuthorPoint{*place_px, 0.0};
  const auto time_s = parseNumberInRange<double>(text.substr(at + 1), 0.0, kLongestClip_s);
  if (!time_s) return std::nullopt;
  return AuthorPoint{*place_px, *time_s};
}

void addVisionOptions(CLI::App& app, VisionSettings& vision) {
  addPoints(app, vision);
  addChoice(app, "--segment", vision.segment, kSegmentModes,
            "The segmentation: the source's mask (source), a mask tracked from frame to frame in a "
            "band around its contour (band), or closed Canny edges (edges). auto: the source's "
            "mask if there is one, else band");
  addRanges(app, vision);
  addNumber(
      app, "--fov", vision.fov_deg, 10.0, 170.0, "DEG 10..170",
      "The horizontal field of view of the colour camera; default: the clip's intrinsics, else 56");
  app.add_flag("--stretch", vision.stretch,
               "Stretch the picture over the whole 160 x 120 mm (the thesis's two scales)");
  addChoice(app, "--motion", vision.motion, kMotionModes,
            "Velocity from rigid alignment of colour and depth (rgbd), Lucas-Kanade (x, y), depth "
            "differences (z), or none. auto: rgbd");
  app.add_flag("--low-latency", vision.low_latency,
               "One frame of lookahead instead of 80 to 120 ms; a live source then has noisier "
               "accelerations and no impacts");
  addNumber(app, "--vision-threads", vision.threads, std::uint64_t{0}, std::uint64_t{2}, "N 0..2",
            "2: describe a frame while the next one is segmented, with one more frame of delay. 0: "
            "2 for pictures larger than 640x480, without --low-latency and with two processors");
  app.add_flag("--compensate-pan", vision.compensate_pan,
               "The camera pans: measure accelerations and impacts against the background, not "
               "against the picture's frame");
  addNumber(app, "--error-budget", vision.plan.error_budget_N, 0.0, 1.0, "N 0..1",
            "The force error that left-out stages and rounded heights on the wire may cause; "
            "default: 0.007, a tenth of the smallest difference that a hand perceives at 1 N");
  addPlan(app, vision.plan);
  addChoice(app, "--method", vision.method, kMethods,
            "hapticast, or every stage as in the thesis: edges, Gaussian, zero outside the mask, "
            "dense grid, stretched");
}

void addName(CLI::App& app, std::string& name) {
  const auto set = [&name](const std::string& text) {
    if (text.empty() || text.size() > limits::kStreamName) {
      throw CLI::ValidationError("--name", "has " + std::to_string(text.size()) +
                                               " bytes; allowed is a text of 1 to " +
                                               std::to_string(limits::kStreamName));
    }
    name = text;
  };
  app.add_option_function<std::string>(
         "--name", set,
         "The stream's name for the viewers; default: the name of the folder or file")
      ->type_name("TEXT");
}

void addMaterialOptions(CLI::App& app, Material& material, std::optional<double>& mass_kg) {
  addNumber(app, "--stiffness", material.stiffness_N_mm, 0.01, 10.0, "N/MM 0.01..10",
            "The surface's stiffness; default: each viewer's own");
  addFriction(app, material);
  addNumber(app, "--damping", material.damping_Ns_m, 0.0, 1000.0, "NS/M 0..1000",
            "Damping in addition to the damping that keeps the surface stable; each viewer's "
            "device limits it");
  addNumber(app, "--texture-depth", material.texture_K_mm, 0.0, 1000.0, "MM 0..1000",
            "K of the thesis's Eq. 3 (viewers with --surface perturbed); default: 30");
  addNumber(app, "--mass", mass_kg, 0.001, 100.0, "KG 0.001..100",
            "The object's mass for the dynamic force; default: each viewer's choice");
}

}  // namespace hapticast::server
