// SPDX-License-Identifier: MIT
#include "server/preview/preview.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <span>
#include <stdexcept>
#include <vector>

#include "common/text.hpp"
#include "common/write_file.hpp"
#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/open_clip.hpp"
#include "server/preview/candidates.hpp"
#include "server/preview/contact_sheet.hpp"
#include "server/preview/correction_hint.hpp"
#include "server/preview/preview_scene.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

namespace fs = std::filesystem;

constexpr double kLive_s = 3.0;     // chosen: duration of a live source's preview
constexpr std::size_t kSheet = 24;  // frames of a contact sheet
constexpr double kFewLost = 0.05;   // chosen, of the frames: not worth a hint
constexpr double kSeen = 0.5;       // quality below which an object is only extrapolated; chosen

/// Statistics and samples of the whole clip.
struct PreviewRun {
  std::vector<PreviewFrame> kept;  // about kSheet, evenly over the clip, the first frame first
  std::uint64_t frames = 0;
  std::uint64_t lost = 0;  // frames without a visible object
  std::optional<double> first_lost_s;
};

[[noreturn]] void throwCannotWrite(const std::string& place, const std::string& what) {
  throw SourceError(fmt::format("--preview {}: {}", place, what));
}

bool isPicture(const fs::path& place) { return hasEnding(place.string(), ".png"); }

// Checks the output place before the clip is processed for minutes.
void checkPlace(const fs::path& place) {
  std::error_code error;
  if (!isPicture(place)) {
    fs::create_directory(place, error);
    if (!fs::is_directory(place, error))
      throwCannotWrite(place.string(),
                       "is not a folder and cannot be created; name a path in a folder of yours");
  }
  const fs::path probe = isPicture(place) ? place : place / "first.png";
  const bool is_new = !fs::exists(probe, error);
  if (!std::ofstream(probe, std::ios::app))
    throwCannotWrite(place.string(), "cannot be written; use a file in a folder of yours");
  if (is_new) fs::remove(probe, error);
}

void writeBytes(const fs::path& file, std::span<const unsigned char> bytes) {
  if (const auto error = writeFile(file.string(), bytes))
    throw std::runtime_error(fmt::format("--preview {}: {}", file.string(), error->message));
  fmt::print("written: {}\n", file.string());
}

void write(const fs::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> png;
  cv::imencode(".png", picture, png);
  writeBytes(file, png);
}

void writeText(const fs::path& file, const std::string& text) {
  writeBytes(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

bool seesAny(const HapticFrame& frame) {
  return std::any_of(frame.objects.begin(), frame.objects.end(),
                     [](const HapticObject& object) { return object.motion.quality >= kSeen; });
}

// Samples every n-th frame; at twice the wanted number it drops every second sample and doubles n.
class Keeper {
 public:
  void take(PreviewFrame frame) {
    const std::uint64_t index = out_.frames++;
    if (!seesAny(frame.haptic)) {
      ++out_.lost;
      if (!out_.first_lost_s) out_.first_lost_s = frame.time_s;
    }
    if (index % every_ != 0) return;
    out_.kept.push_back(std::move(frame));
    if (out_.kept.size() < 2 * kSheet) return;
    std::vector<PreviewFrame> half;
    half.reserve(kSheet);
    for (std::size_t i = 0; i < out_.kept.size(); i += 2) half.push_back(std::move(out_.kept[i]));
    out_.kept = std::move(half);
    every_ *= 2;
  }
  PreviewRun finish() {
    // Between kSheet and twice as many samples remain: selects an even subset.
    if (out_.kept.size() <= kSheet) return std::move(out_);
    std::vector<PreviewFrame> chosen;
    chosen.reserve(kSheet);
    for (std::size_t i = 0; i < kSheet; ++i)
      chosen.push_back(out_.kept[i * (out_.kept.size() - 1) / (kSheet - 1)]);
    out_.kept = std::move(chosen);
    return std::move(out_);
  }

 private:
  PreviewRun out_;
  std::uint64_t every_ = 1;
};

PreviewRun runVision(RgbdSource& source, Vision& vision, std::uint64_t most_frames) {
  const SourceInfo& info = source.info();
  if (info.live) {
    const auto live = static_cast<std::uint64_t>(kLive_s * info.fps);
    most_frames = most_frames == 0 ? live : std::min(most_frames, live);
  }
  Keeper keeper;
  std::deque<std::pair<double, cv::Mat>> pending;  // time and depth of frames inside vision
  const auto take = [&](VisionResult& result) {
    keeper.take({pending.front().first, result.color, pending.front().second,
                 std::move(result.frame), info.own_px});
    pending.pop_front();
  };
  for (std::uint64_t n = 0; most_frames == 0 || n < most_frames;) {
    const std::optional<RgbdFrame> frame = source.read();
    if (!frame && info.live) continue;
    if (!frame) break;
    pending.emplace_back(frame->clip_time_s, frame->depth);
    const MediaTime time = MediaTime{} + fromSeconds(static_cast<double>(n++) / info.fps);
    if (auto result = vision.push(*frame, time)) take(*result);
  }
  for (VisionResult& result : vision.flush()) take(result);
  return keeper.finish();
}

/// Returns the advice for a clip whose first frame shows no object.
std::string suggestObject(const PreviewRun& preview_run) {
  const auto seen = std::find_if(preview_run.kept.begin(), preview_run.kept.end(),
                                 [](const PreviewFrame& each) { return seesAny(each.haptic); });
  if (seen == preview_run.kept.end())
    return "no object was found; add --object U,V with a pixel on one";
  return fmt::format(
      "the first frame shows no object, but that at {0:.2f} s does; add --object U,V@{0:.2f}",
      seen->time_s);
}

std::string suggestCorrections(const Settings& settings, const PreviewRun& preview_run,
                               const SourceInfo& info) {
  const PreviewFrame& first = preview_run.kept.front();
  const std::vector<std::uint32_t> ids = listIds(first.haptic);
  if (ids.empty()) return suggestObject(preview_run);
  std::vector<cv::Point> clicks;
  for (const AuthorPoint& point : settings.vision.object_points)
    clicks.emplace_back(static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y()));
  RgbdFrame frame;
  frame.color = first.color;
  frame.depth = first.depth;
  const FrameImages images = makeFrameImages(frame, info);
  for (const std::uint32_t id : ids) {
    const cv::Mat mask = renderMask(first.haptic, id, first.color.size());
    if (const auto hint = suggestCorrection(images, mask, clicks)) {
      const Vec2 at_px = Vec2(hint->at_px.x + 0.5, hint->at_px.y + 0.5).cwiseProduct(first.own_px);
      const std::string point =
          fmt::format("{:.0f},{:.0f}", std::floor(at_px.x()), std::floor(at_px.y()));
      return fmt::format("if object {} should not include the pixel {}, try --not {}: {}", id,
                         point, point, hint->why);
    }
  }
  if (double(preview_run.lost) > kFewLost * double(preview_run.frames)) {
    return fmt::format(
        "the server loses the object at {:.2f} s: check that frame, and try --object U,V@{:.2f}",
        *preview_run.first_lost_s, *preview_run.first_lost_s);
  }
  if (settings.vision.object_points.empty())
    return "the server chose this object automatically; to choose another one, add --object U,V";
  return "no wrong part was detected; check the outline, and to remove a part of it, add --not U,V "
         "with a pixel on that part";
}

std::string introduce(const std::string& name) { return name.empty() ? "" : quote(name) + ", "; }

std::vector<std::string> formatLines(const Settings& settings, const PreviewRun& preview_run,
                                     const SourceInfo& info, const Vision& vision) {
  const PreviewFrame& first = preview_run.kept.front();
  std::vector<std::string> lines;
  for (const std::uint32_t id : listIds(first.haptic))
    lines.push_back(
        introduce(vision.name(id)) +
        toText(objectStats(first, id, vision.description().workspace), info.depth_kind));
  lines.push_back(fmt::format("no object found in {} of {} frames ({:.1f} %)", preview_run.lost,
                              preview_run.frames,
                              100.0 * double(preview_run.lost) / double(preview_run.frames)));
  lines.push_back(suggestCorrections(settings, preview_run, info));
  return lines;
}

/// Writes a picture of the candidates for the object of the first point, if there are several.
void writeCandidates(RgbdSource& source, const VisionSettings& settings, const fs::path& folder) {
  const std::vector<PreviewFrame> candidates = listCandidates(source, settings);
  if (candidates.size() < 2) return;
  write(folder / "candidates.png", drawCandidates(candidates, settings));
  const AuthorPoint& point = settings.object_points.front();
  const Vec2 at_px = point.at_px.cwiseProduct(source.info().own_px);
  fmt::print(
      "the first mask has {} candidates: candidates.png; pick one with --object {:g},{:g}#2\n",
      candidates.size(), at_px.x(), at_px.y());
}

}  // namespace

void writePreview(Settings settings, const Clock& clock) {
  const fs::path place = settings.preview;
  const std::unique_ptr<RgbdSource> source = openClip(settings);
  checkPlace(place);
  settings.vision = preparePoints(settings.vision, source->info());
  Vision vision(source->info(), settings.vision);
  warnOfUnlikelyInput(*source, settings.vision);
  const LocalMediaClock media_clock(clock);
  scanClip(vision, *source, media_clock, nullptr);
  const PreviewRun preview_run = runVision(*source, vision, settings.frames);
  if (preview_run.kept.empty())
    throw SourceError(hideCredentials(settings.source) + ": has no frame");
  const Workspace& workspace = vision.description().workspace;
  const std::vector<std::string> lines = formatLines(settings, preview_run, source->info(), vision);
  const cv::Mat first = drawFirst(preview_run.kept.front(), workspace, settings.vision, lines);
  for (const std::string& line : lines) fmt::print("{}\n", line);
  if (isPicture(place)) {
    write(place, first);
  } else {
    write(place / "first.png", first);
    writeCandidates(*source, settings.vision, place);
    write(place / "clip.png", drawContactSheet(preview_run.kept, settings.vision));
    writeText(place / "scene.json",
              formatScene(completeScene(settings, preview_run.kept.front(), source->info())));
  }
}

}  // namespace hapticast::server
