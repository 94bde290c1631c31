// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "server/source/rgbd_source.hpp"
#include "tests/evaluate/figures/figures_moments.hpp"
#include "tests/evaluate/figures/figures_parts.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

/// Returns the path (ms, nominal mm) of a tip that is attached to the reference point of the first
/// object, 1 mm below the surface. The tip comes from above.
std::map<std::int64_t, Vec3> attachedPath(const Stream& stream) {
  std::map<std::int64_t, Vec3> path;
  const auto far = [](double) { return HandPoint{{0, 0, 100}, Vec3::Zero()}; };
  renderTrace(stream, defaultVariant(), far, {},
              [&](const client::Scene& scene, const client::StreamTiming& timing,
                  const client::Contact&, const Tick& tick) {
                if (scene.object_count == 0) return;
                const client::InterpolatedObject& body = scene.objects[0];
                Vec3 at_mm = body.position_mm;
                const auto under = client::evaluateSurface(body, at_mm.head<2>(), timing.workspace);
                at_mm.z() = under.sample.height_mm - 1.0 +
                            12.0 * std::max(0.0, 1.0 - (tick.time_s - 0.4) / 0.2);
                path[std::llround(tick.time_s * 1e3)] = at_mm;
              });
  return path;
}

}  // namespace

void drawRealClip(const Options& options) {
  const std::filesystem::path clip = test::clipsFolder() / "visp_rbt_desk";
  if (!std::filesystem::exists(clip)) {
    std::fprintf(stderr, "note: figure 9 is left out, there is no %s\n", clip.c_str());
    return;
  }
  std::map<std::string, Stream> streams;
  const std::vector<Variant> variants{thesisVariant(), defaultVariant()};
  for (const Variant& variant : variants) {
    const auto source = server::openSource(clip.string(), 0.0);
    server::VisionSettings settings;
    settings.method = variant.method;
    settings.object_points = {{{505, 330}}};
    settings.stretch = false;
    streams[variant.name] = makeStream(*source, settings, true);
  }
  const std::map<std::int64_t, Vec3> path = attachedPath(streams[defaultVariant().name]);
  const Hand hand = [&](double t) {
    const auto at = path.lower_bound(std::llround(t * 1e3));
    return HandPoint{at != path.end() ? at->second : Vec3(0, 0, 100), Vec3::Zero()};
  };
  std::vector<CurvePanel> panels;
  for (const Variant& variant : variants) {
    const std::vector<Moment> moments =
        forcesOf(streams[variant.name], variant, hand, nullptr, nullptr);
    const std::string method = variant.is_thesis ? "thesis" : "hapticast";
    for (const int axis : {0, 1}) panels.push_back(forcePanel(moments, axis, method));
  }
  shareScale(panels);
  plotCurves(options.out / "figure_9.png", panels, 2);
}

}  // namespace hapticast::evaluate
