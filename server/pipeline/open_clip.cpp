// SPDX-License-Identifier: MIT
#include "server/pipeline/open_clip.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "server/source/child/child_source.hpp"
#include "server/source/child/depth_task.hpp"
#include "server/source/child/mask_task.hpp"
#include "server/source/folder/clip_files.hpp"
#include "server/source/folder/key_mask_source.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

/// Returns the colour images of a folder; an empty vector if it is no folder of images.
std::vector<fs::path> listClipImages(const Settings& settings, bool color_only) {
  VideoLayout layout = settings.layout;
  layout.color_only = color_only;
  std::vector<fs::path> images;
  try {
    for (const FrameFiles& frame : findClipFiles(settings.source, layout).frames)
      images.push_back(frame.color);
  } catch (const SourceError&) {  // a video in a folder
  }
  return images;
}

/// Returns the files with the colours of a clip: its images, or the files in its folder, or the
/// file itself. Returns an empty vector for a source without files.
std::vector<fs::path> listColorFiles(const Settings& settings) {
  std::error_code error;
  if (fs::is_regular_file(settings.source, error)) return {settings.source};
  if (!fs::is_directory(settings.source, error)) return {};
  std::vector<fs::path> files = listClipImages(settings, true);
  if (!files.empty()) return files;
  for (const auto& entry : fs::directory_iterator(settings.source, error)) {
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::unique_ptr<RgbdSource> addDepth(std::unique_ptr<RgbdSource> source, const Settings& settings,
                                     const KeepWaiting& keep_waiting) {
  const ChildSettings& child = settings.child;
  if (child.depth_command.empty()) return source;
  const SourceInfo& info = source->info();
  std::unique_ptr<DepthCache> cache;
  if (!child.depth_cache.empty()) {
    if (info.live)
      throw SourceError("--depth-cache: a live source does not come again; leave the flag out");
    cache = std::make_unique<DepthCache>(
        child.depth_cache, child.depth_cache_GB,
        describeCachedClip(settings.source, listColorFiles(settings), info, child.depth_command));
  }
  auto task = std::make_unique<DepthTask>(
      child.depth_command, settings.vision.depth_range.value_or(kRelativeRange), std::move(cache));
  return std::make_unique<ChildSource>(std::move(source), std::move(task), keep_waiting);
}

/// Returns the author's points in px of the frames. Points of --object without a number are objects
/// of their own, in their order.
std::vector<MaskPoint> listMaskPoints(const VisionSettings& vision, const SourceInfo& info) {
  std::vector<MaskPoint> points;
  int next = static_cast<int>(vision.objects.size()) + 1;
  for (const AuthorPoint& point : vision.object_points) {
    const int object = point.number > 0 ? point.number : next++;
    points.push_back({point.at_px.cwiseQuotient(info.own_px), point.time_s, object});
  }
  for (const AuthorPoint& point : vision.not_points)
    points.push_back({point.at_px.cwiseQuotient(info.own_px), point.time_s, 0});
  return points;
}

std::string describeMaskOrigin(const std::string& command, const std::vector<MaskPoint>& points) {
  std::ostringstream text;
  text << command << '\n';
  for (const MaskPoint& point : points)
    text << point.object << ' ' << point.at_px.x() << ' ' << point.at_px.y() << ' ' << point.time_s
         << '\n';
  return text.str();
}

/// Returns the folder that keeps the masks; null if the clip is no plain folder of images of the
/// size of the frames.
std::unique_ptr<MaskFolder> openMaskFolder(const Settings& settings, const SourceInfo& info,
                                           const std::vector<MaskPoint>& points) {
  std::error_code error;
  const fs::path folder = settings.source;
  if (!fs::is_directory(folder, error) || info.own_px != Vec2::Ones()) return nullptr;
  for (const char* other : {"rgb.txt", "scene_camera.json", "metadata.yaml"}) {
    if (fs::exists(folder / other, error)) return nullptr;  // its masks have other places, or none
  }
  std::vector<std::string> names;
  for (const fs::path& image : listClipImages(settings, !settings.child.depth_command.empty()))
    names.push_back(image.stem().string());
  if (names.empty()) return nullptr;
  return std::make_unique<MaskFolder>(folder, std::move(names),
                                      describeMaskOrigin(settings.child.mask_command, points));
}

std::unique_ptr<RgbdSource> addMasks(std::unique_ptr<RgbdSource> source, const Settings& settings,
                                     const KeepWaiting& keep_waiting) {
  const ChildSettings& child = settings.child;
  if (child.mask_command.empty()) return source;
  std::vector<MaskPoint> points = listMaskPoints(settings.vision, source->info());
  auto folder = openMaskFolder(settings, source->info(), points);
  if (folder != nullptr && folder->isComplete()) return source;  // which reads them
  auto task = std::make_unique<MaskTask>(child.mask_command, std::move(points), std::move(folder),
                                         source->info().live);
  return std::make_unique<ChildSource>(std::move(source), std::move(task), keep_waiting);
}

}  // namespace

std::unique_ptr<RgbdSource> openClip(const Settings& settings, const KeepWaiting& keep_waiting) {
  VideoLayout layout = settings.layout;
  layout.color_only = !settings.child.depth_command.empty();
  auto source = openSource(settings.source, settings.fps, settings.to_and_fro, layout);
  source = addDepth(std::move(source), settings, keep_waiting);
  source = addMasks(std::move(source), settings, keep_waiting);
  return addKeyMasks(std::move(source), settings.key_masks);
}

SourceInfo describeSource(const RgbdSource& source, const Settings& settings) {
  SourceInfo info = source.info();
  if (!settings.name.empty()) info.name = settings.name;
  return info;
}

}  // namespace hapticast::server
