// SPDX-License-Identifier: MIT
#include "server/source/folder/clip_files.hpp"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <cstdint>
#include <map>

#include "server/source/folder/bop_scene.hpp"
#include "server/source/folder/clip_meta.hpp"
#include "server/source/folder/frame_number.hpp"
#include "server/source/folder/image_lists.hpp"
#include "server/source/folder/text_file.hpp"
#include "server/source/folder/timed_images.hpp"
#include "server/source/picture/npy_stack.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

void requireCount(const std::string& place, std::size_t count, std::size_t colors) {
  if (count == colors) return;
  throw SourceError(place + ": " + std::to_string(count) + " images, but there are " +
                    std::to_string(colors) +
                    " colour images; each colour image needs its own, so add or remove some");
}

// Masks as many as pictures pair in order; fewer masks pair by name.
void addMasks(const fs::path& folder, ClipFiles& clip) {
  const auto masks = listColorImages(folder);
  if (masks.size() >= clip.frames.size()) {
    requireCount(folder.string(), masks.size(), clip.frames.size());
    for (std::size_t i = 0; i < masks.size(); ++i) clip.frames[i].mask = masks[i];
    return;
  }
  std::map<std::string, FrameFiles*> by_name;
  for (FrameFiles& frame : clip.frames) by_name[frame.color.stem().string()] = &frame;
  for (const fs::path& mask : masks) {
    const auto found = by_name.find(mask.stem().string());
    if (found == by_name.end()) {
      throw SourceError(mask.string() +
                        ": no colour image has this name; name a key mask like its picture");
    }
    if (!found->second->mask.empty()) {
      throw SourceError(mask.string() + ": is a second key mask of one picture; remove one");
    }
    found->second->mask = mask;
    clip.key_masks = true;
  }
}

// Warns of the first pair whose names have other frame numbers.
void warnOfOtherNumbers(const ClipFiles& clip) {
  for (const FrameFiles& frame : clip.frames) {
    const auto color = frameNumber(frame.color);
    const auto depth = frameNumber(frame.depth);
    if (!color || !depth || *color == *depth) continue;
    spdlog::warn(
        "--source {}: belongs to colour {} by its place, but the numbers in their names differ; if "
        "images are missing, the depths are of other moments, so name each pair alike",
        frame.depth.string(), frame.color.filename().string());
    return;
  }
}

/// Pairs images by the frame numbers in their names. A colour image without depth is a gap.
std::vector<FrameFiles> pairByNumber(const std::vector<fs::path>& colors,
                                     const std::vector<fs::path>& depths,
                                     const std::string& depth_place) {
  std::map<std::uint64_t, fs::path> by_number;
  for (const fs::path& depth : depths) {
    if (const auto number = frameNumber(depth)) by_number[*number] = depth;
  }
  std::vector<FrameFiles> frames;
  std::size_t pairs = 0;
  for (const fs::path& color : colors) {
    const auto number = frameNumber(color);
    const auto found = number ? by_number.find(*number) : by_number.end();
    const bool has_depth = found != by_number.end();
    FrameFiles& frame = frames.emplace_back();
    frame.color = color;
    if (has_depth) frame.depth = found->second;
    pairs += has_depth ? 1 : 0;
  }
  if (pairs == 0) requireCount(depth_place, depths.size(), colors.size());
  return frames;
}

/// Returns a clip of `colors` with the depth pictures in the file `array`, in their order.
ClipFiles pairWithArray(const std::vector<fs::path>& colors, const fs::path& array) {
  requireCount(array.string(), NpyStack(array).count(), colors.size());
  ClipFiles clip;
  clip.depth_array = array;
  for (std::size_t i = 0; i < colors.size(); ++i)
    clip.frames.push_back({colors[i], array, {}, {}, {}, i});
  return clip;
}

/// Returns a clip of the colour and depth images `images`.
ClipFiles pairImages(const ImageLists& images) {
  const auto& [colors, depths, depth_place, array] = images;
  ClipFiles clip;
  if (pairByStamps(colors, depths, clip)) return clip;
  if (depths.size() != colors.size()) {
    clip.frames = pairByNumber(colors, depths, depth_place);
    return clip;
  }
  for (std::size_t i = 0; i < colors.size(); ++i)
    clip.frames.push_back({colors[i], depths[i], {}, {}, {}});
  warnOfOtherNumbers(clip);
  return clip;
}

ClipFiles findInFolders(const fs::path& folder, const VideoLayout& layout) {
  const ImageLists images = findImages(folder, layout);
  ClipFiles clip = images.depth_array.empty() ? pairImages(images)
                                              : pairWithArray(images.colors, images.depth_array);
  if (layout.color_only)
    for (FrameFiles& frame : clip.frames) frame.depth.clear();
  if (fs::exists(folder / "scene_camera.json"))
    addBopScene(folder, readText(folder / "scene_camera.json"), clip);
  else if (const fs::path masks = findFolder(folder, {"mask"}); !masks.empty())
    addMasks(masks, clip);
  return clip;
}

void applyMeta(const fs::path& file, ClipFiles& clip) {
  const ClipMeta meta = parseClipMeta(readText(file), file.string());
  clip.fps = meta.fps.value_or(clip.fps);
  if (meta.mm_per_unit) clip.mm_per_unit = meta.mm_per_unit;
  if (meta.depth_bits) clip.declared_depth_bits = meta.depth_bits;
  if (meta.fov_deg) clip.fov_deg = meta.fov_deg;
  if (meta.camera) clip.camera = meta.camera;
  clip.declared_width_px = meta.width_px;
  clip.declared_height_px = meta.height_px;
}

}  // namespace

ClipFiles findClipFiles(const fs::path& folder, const VideoLayout& layout) try {
  if (!fs::is_directory(folder)) throw SourceError(folder.string() + ": no such folder");
  const bool tum = !layout.color_only && layout.color_glob.empty() &&
                   fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt");
  ClipFiles clip = tum ? findTum(folder) : findInFolders(folder, layout);
  if (fs::exists(folder / "meta.json")) applyMeta(folder / "meta.json", clip);
  return clip;
} catch (const fs::filesystem_error& error) {
  throw SourceError(folder.string() + ": cannot be read (" + error.code().message() + ")");
}

}  // namespace hapticast::server
