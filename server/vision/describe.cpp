// SPDX-License-Identifier: MIT
#include "server/vision/describe.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

namespace hapticast::server {

namespace {

constexpr double kStep_mm = 3.0;  // nominal, chosen: smallest step that a hand perceives as a gap

bool equalReliefs(const Relief& a, const Relief& b) {
  return a.rect == b.rect && a.mask == b.mask && a.height_mm == b.height_mm;
}

std::shared_ptr<const Relief> makeRelief(const TrackedObject& object, const NominalFrame& nominal,
                                         const VisionSettings& settings, const Clock* clock,
                                         StageReport& report) {
  const auto make = [&](bool smooth) {
    return makeRelief(object.surface, nominal.range, nominal.workspace, settings.method, smooth);
  };
  if (settings.method == Method::kThesis) return make(true);
  if (!object.smooths && !object.measures_smooth) return make(false);
  std::shared_ptr<const Relief> smoothed;
  {
    const ScopedStageTimer lap(clock, report, Stage::kSmooth);
    smoothed = make(true);
  }
  if (object.measures_smooth) {
    report.costs_N[std::size_t(Stage::kSmooth)] = forceDifference_N(
        *smoothed, *make(false), nominal.workspace.mmPerPixel().x(), settings.stiffness_N_mm());
  }
  return smoothed;
}

// Returns the heights that this frame alone measured of a layer; null if it measured none. Pixels
// without a measurement, or with one that is `step_mm` off (another layer's), have the layer's own.
std::shared_ptr<const Relief> makeMeasured(const TrackedObject& object, const Relief& layer,
                                           double step_mm, const NominalFrame& nominal,
                                           const VisionSettings& settings) {
  const PixelRect& rect = layer.rect;
  const cv::Rect box(rect.u, rect.v, rect.width, rect.height);
  const Surface& sent = object.surface;
  if (object.measured.box.empty() || (box & sent.box) != box) return nullptr;
  const cv::Rect inner = box - sent.box.tl();
  Surface part{box,
               cv::Mat(box.size(), CV_8UC1, const_cast<std::uint8_t*>(layer.mask.data())) * 255,
               sent.depth(inner).clone(),
               sent.measured(inner).clone(),
               sent.quantum_mm,
               sent.reduction};
  part.measured &= part.mask;
  const cv::Rect common = box & object.measured.box;
  if (common.empty()) return nullptr;
  const cv::Mat depth = object.measured.depth(common - object.measured.box.tl());
  cv::Mat out = part.depth(common - box.tl());
  const cv::Mat near = cv::abs(depth - out) < step_mm;
  depth.copyTo(out, near & object.measured.mask(common - object.measured.box.tl()));
  return makeRelief(part, nominal.range, nominal.workspace, settings.method,
                    object.smooths || object.measures_smooth);
}

// Returns whether unchanged heights are sent too.
bool sendsAllHeights(const PlanSettings& plan) {
  return plan.forced[std::size_t(Stage::kHeights)].value_or(plan.everything);
}

}  // namespace

HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings, const Clock* clock,
                            StageReport& report) {
  HapticObject out;
  out.id = object.id;
  out.material = settings.findMaterial(object.number);
  out.motion.quality = object.quality;
  out.motion.visible_fraction = object.visible_fraction;
  const bool stays = last != nullptr && (!object.seen || object.atRest());
  const bool sends_all = sendsAllHeights(settings.plan);
  if (!stays || (object.seen && sends_all)) {
    out.relief = makeRelief(object, nominal, settings, clock, report);
    out.changed_in_frame = frame_id;
  }
  const bool unchanged = last != nullptr && (stays || equalReliefs(*out.relief, *last->relief));
  report.unchanged = unchanged;
  if (unchanged && (!out.relief || !sends_all)) {
    out.relief = last->relief;
    out.changed_in_frame = last->changed_in_frame;
  }
  return out;
}

namespace {

Described describeSent(const TrackedObject& object, std::uint64_t frame_id,
                       const std::vector<HapticObject>& last, double step_mm,
                       const NominalFrame& nominal, const VisionSettings& settings,
                       const Clock* clock, LayerCutter& cutter) {
  std::vector<const HapticObject*> before(kMaxLayers, nullptr);
  for (const HapticObject& other : last) {
    if (other.id == object.id && other.layer < before.size()) before[other.layer] = &other;
  }
  Described out;
  const auto add = [&](const TrackedObject& part, std::uint32_t layer) {
    out.layers.push_back(
        describeObject(part, frame_id, before[layer], nominal, settings, clock, out.report));
    out.layers.back().layer = layer;
  };
  const bool known = std::any_of(before.begin(), before.end(), [](const auto* o) { return o; });
  const bool kept = object.atRest() && !sendsAllHeights(settings.plan);
  if (known && (!object.seen || kept)) {
    for (std::uint32_t layer = 0; layer < before.size(); ++layer) {
      if (before[layer] != nullptr) add(object, layer);
    }
    return out;
  }
  if (settings.method == Method::kThesis) {
    add(object, 0);
    return out;
  }
  std::uint32_t layer = 0;
  TrackedObject part = object;
  for (Surface& surface : cutter.cut(object.surface, step_mm, nominal.range)) {
    part.surface = std::move(surface);
    if (!part.surface.box.empty()) add(part, layer);
    ++layer;
  }
  return out;
}

}  // namespace

Described describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                         const std::vector<HapticObject>& last, const DepthNoise& noise,
                         const NominalFrame& nominal, const VisionSettings& settings,
                         const Clock* clock, LayerCutter& cutter) {
  const double step_mm =
      std::max(noise.step_mm(object.pose.depth_mm), kStep_mm / std::abs(nominal.mmPerStep().z()));
  Described out = describeSent(object, frame_id, last, step_mm, nominal, settings, clock, cutter);
  if (!settings.offline || settings.method == Method::kThesis) return out;
  for (const HapticObject& layer : out.layers)
    out.measured.push_back(makeMeasured(object, *layer.relief, step_mm, nominal, settings));
  return out;
}

std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality) {
  std::vector<std::uint8_t> bytes;
  if (color.empty() || color.type() != CV_8UC3) return bytes;
  if (!cv::imencode(".jpg", color, bytes, {cv::IMWRITE_JPEG_QUALITY, std::clamp(quality, 1, 100)}))
    bytes.clear();
  return bytes;
}

}  // namespace hapticast::server
