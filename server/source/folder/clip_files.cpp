// SPDX-License-Identifier: MIT
#include "server/source/folder/clip_files.hpp"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "server/source/folder/bop_scene.hpp"
#include "server/source/folder/frame_number.hpp"
#include "server/source/folder/text_file.hpp"
#include "server/source/folder/timed_images.hpp"
#include "server/source/picture/npy_stack.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

using Endings = std::span<const std::string_view>;
constexpr std::array<std::string_view, 3> kColorEndings{".png", ".jpg", ".jpeg"};
constexpr std::array<std::string_view, 3> kOtherColorEndings{".webp", ".bmp", ".ppm"};
constexpr std::array<std::string_view, 8> kDepthEndings{".png",  ".jpg", ".jpeg", ".tif",
                                                        ".tiff", ".exr", ".pgm",  ".npy"};
constexpr std::array<std::string_view, 2> kOtherDepthEndings{".pfm", ".npz"};

bool isImage(const fs::path& file, Endings endings) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(endings.begin(), endings.end(), extension) != endings.end();
}

std::vector<fs::path> listFiles(const fs::path& folder, Endings endings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& file = it->path();
    if (file.filename().string().front() != '.' && isImage(file, endings)) files.push_back(file);
  }
  if (error) throw SourceError(folder.string() + ": cannot be read (" + error.message() + ")");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return precedesNaturally(a.filename().string(), b.filename().string());
  });
  return files;
}

/// Returns the images in `folder` in the order of their names. Those of the other formats count
/// only if there are no others, because a folder may have each picture in two formats.
std::vector<fs::path> listImages(const fs::path& folder, Endings endings = kColorEndings,
                                 Endings other_endings = kOtherColorEndings) {
  std::vector<fs::path> files = listFiles(folder, endings);
  return files.empty() ? listFiles(folder, other_endings) : files;
}

void requireCount(const fs::path& folder, std::size_t count, std::size_t colors) {
  if (count == colors) return;
  throw SourceError(folder.string() + ": " + std::to_string(count) + " images, but there are " +
                    std::to_string(colors) +
                    " colour images; each colour image needs its own, so add or remove some");
}

// Masks as many as pictures pair in order; fewer masks pair by name.
void addMasks(const fs::path& folder, ClipFiles& clip) {
  const auto masks = listImages(folder);
  if (masks.size() >= clip.frames.size()) {
    requireCount(folder, masks.size(), clip.frames.size());
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

/// Returns the first of `names` that is a folder in `folder`. Returns an empty path if none is.
fs::path findFolder(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (fs::is_directory(folder / name)) return folder / name;
  }
  return {};
}

/// Pairs images by the frame numbers in their names. A colour image without depth is a gap.
std::vector<FrameFiles> pairByNumber(const std::vector<fs::path>& colors,
                                     const std::vector<fs::path>& depths,
                                     const fs::path& depth_folder) {
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
  if (pairs == 0) requireCount(depth_folder, depths.size(), colors.size());
  return frames;
}

/// Returns the file in `folder` with the depth of all frames; an empty path if there is none.
fs::path findDepthArray(const fs::path& folder) {
  for (const char* name : {"depth.npy", "depths.npy", "depth.npz", "depths.npz"}) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  return {};
}

/// Returns a clip of `colors` with the depth pictures in the file `array`, in their order.
ClipFiles pairWithArray(const std::vector<fs::path>& colors, const fs::path& array) {
  requireCount(array, NpyStack(array).count(), colors.size());
  ClipFiles clip;
  clip.depth_array = array;
  for (std::size_t i = 0; i < colors.size(); ++i)
    clip.frames.push_back({colors[i], array, {}, {}, {}, i});
  return clip;
}

/// Returns a clip of `colors` with the depth images in `depth_folder`.
ClipFiles pairWithImages(const std::vector<fs::path>& colors, const fs::path& depth_folder) {
  const auto depths = listDepthImages(depth_folder);
  if (depths.empty()) {
    throw SourceError(
        depth_folder.string() +
        ": has no PNG, JPEG, TIFF, EXR, PGM, PFM, NPY or NPZ images; put a depth image for each "
        "colour image there");
  }
  ClipFiles clip;
  if (pairByStamps(colors, depths, clip)) return clip;
  if (depths.size() != colors.size()) {
    clip.frames = pairByNumber(colors, depths, depth_folder);
    return clip;
  }
  for (std::size_t i = 0; i < colors.size(); ++i)
    clip.frames.push_back({colors[i], depths[i], {}, {}, {}});
  warnOfOtherNumbers(clip);
  return clip;
}

ClipFiles findInFolders(const fs::path& folder) {
  const fs::path color_folder = findFolder(folder, {"rgb", "color", "colour", "image", "images"});
  if (color_folder.empty()) {
    const bool empty = fs::is_empty(folder);
    throw SourceError(folder.string() + (empty ? ": is empty" : ": has no folder rgb/ or color/") +
                      "; put colour images into rgb/ and depth images into depth/");
  }
  const fs::path depth_folder =
      findFolder(folder, {"depth", "aligned_depth", "depth_aligned", "depths"});
  const fs::path array = depth_folder.empty() ? findDepthArray(folder) : fs::path();
  if (depth_folder.empty() && array.empty()) {
    throw SourceError(folder.string() +
                      ": has no folder depth/; put a depth image for each colour image into it, or "
                      "the depth of all frames into one array depth.npy or depth.npz");
  }
  const auto colors = listImages(color_folder);
  if (colors.empty()) {
    throw SourceError(color_folder.string() +
                      ": has no PNG, JPEG, WebP, BMP or PPM images; put the frames there");
  }
  ClipFiles clip =
      array.empty() ? pairWithImages(colors, depth_folder) : pairWithArray(colors, array);
  if (fs::exists(folder / "scene_camera.json"))
    addBopScene(folder, readText(folder / "scene_camera.json"), clip);
  else if (fs::is_directory(folder / "mask"))
    addMasks(folder / "mask", clip);
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

std::vector<fs::path> listDepthImages(const fs::path& folder) {
  return listImages(folder, kDepthEndings, kOtherDepthEndings);
}

bool precedesNaturally(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t i0 = i;
    const std::size_t j0 = j;
    while (i < a.size() && digit(a[i])) ++i;
    while (j < b.size() && digit(b[j])) ++j;
    if (i - i0 != j - j0) return i - i0 < j - j0;
    const int order = a.compare(i0, i - i0, b, j0, j - j0);
    if (order != 0) return order < 0;
  }
  // Equal by value (01 and 1): any fixed order works.
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

ClipFiles findClipFiles(const fs::path& folder) try {
  if (!fs::is_directory(folder)) throw SourceError(folder.string() + ": no such folder");
  const bool tum = fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt");
  ClipFiles clip = tum ? findTum(folder) : findInFolders(folder);
  if (fs::exists(folder / "meta.json")) applyMeta(folder / "meta.json", clip);
  return clip;
} catch (const fs::filesystem_error& error) {
  throw SourceError(folder.string() + ": cannot be read (" + error.code().message() + ")");
}

}  // namespace hapticast::server
