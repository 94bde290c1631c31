// SPDX-License-Identifier: MIT
#include "server/source/folder/image_lists.hpp"

#include <glob.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>

#include "common/text.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOtherwise =
    "; put colour images into rgb/ and depth images into depth/, or name both with --color 'GLOB' "
    "and --depth 'GLOB'";

using Endings = std::span<const std::string_view>;
constexpr std::array<std::string_view, 3> kColorEndings{".png", ".jpg", ".jpeg"};
constexpr std::array<std::string_view, 3> kOtherColorEndings{".webp", ".bmp", ".ppm"};
constexpr std::array<std::string_view, 8> kDepthEndings{".png",  ".jpg", ".jpeg", ".tif",
                                                        ".tiff", ".exr", ".pgm",  ".npy"};
constexpr std::array<std::string_view, 2> kOtherDepthEndings{".pfm", ".npz"};

bool isImage(const fs::path& file, Endings endings) {
  const std::string extension = toLower(file.extension().string());
  return std::find(endings.begin(), endings.end(), extension) != endings.end();
}

void sortNaturally(std::vector<fs::path>& files) {
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return precedesNaturally(a.filename().string(), b.filename().string());
  });
}

std::vector<fs::path> listFiles(const fs::path& folder, Endings endings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& file = it->path();
    if (file.filename().string().front() != '.' && isImage(file, endings)) files.push_back(file);
  }
  if (error) throw SourceError(folder.string() + ": cannot be read (" + error.message() + ")");
  sortNaturally(files);
  return files;
}

std::vector<fs::path> listImages(const fs::path& folder, Endings endings, Endings others) {
  std::vector<fs::path> files = listFiles(folder, endings);
  return files.empty() ? listFiles(folder, others) : files;
}

/// Returns the files that match the pattern `glob` in `folder`. Throws SourceError if none does.
std::vector<fs::path> listMatches(const fs::path& folder, const std::string& glob,
                                  const char* flag) {
  std::string pattern;
  for (const char c : folder.string()) {  // the folder is no pattern
    if (std::string_view("*?[]{}\\~").find(c) != std::string_view::npos) pattern += '\\';
    pattern += c;
  }
  glob_t matches{};
  const int failed = ::glob((pattern + "/" + glob).c_str(), GLOB_BRACE, nullptr, &matches);
  std::vector<fs::path> files(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  ::globfree(&matches);
  std::erase_if(files, [](const fs::path& file) { return !fs::is_regular_file(file); });
  if (failed != 0 || files.empty())
    throw SourceError(std::string(flag) + " " + quote(glob) + ": matches no file in " +
                      folder.string() + "; give a pattern like 'frame_*.png'");
  sortNaturally(files);
  return files;
}

/// Returns the images that lie in `folder` itself, without colours or depths if it has none.
ImageLists sortFlatImages(const fs::path& folder) {
  ImageLists lists;
  for (const fs::path& file : listFiles(folder, kDepthEndings)) {
    const std::string name = toLower(file.stem().string());
    const auto has = [&name](const char* word) { return name.find(word) != std::string::npos; };
    if (has("conf") || has("mask")) continue;
    if (has("depth")) {
      lists.depths.push_back(file);
    } else if (isImage(file, kColorEndings)) {
      lists.colors.push_back(file);
    }
  }
  lists.depth_place = folder.string();
  return lists;
}

fs::path findDepthArray(const fs::path& folder) {
  for (const char* name : {"depth.npy", "depths.npy", "depth.npz", "depths.npz"}) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  return {};
}

}  // namespace

std::vector<fs::path> listColorImages(const fs::path& folder) {
  return listImages(folder, kColorEndings, kOtherColorEndings);
}

std::vector<fs::path> listDepthImages(const fs::path& folder) {
  return listImages(folder, kDepthEndings, kOtherDepthEndings);
}

fs::path findFolder(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (fs::is_directory(folder / name)) return folder / name;
  }
  for (const char* name : names) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.is_directory() && toLower(entry.path().filename().string()) == name)
        return entry.path();
    }
  }
  return {};
}

fs::path findColorFolder(const fs::path& folder) {
  return findFolder(folder, {"rgb", "color", "colour", "image", "images", "rgb_png", "color_png"});
}

fs::path findDepthFolder(const fs::path& folder) {
  return findFolder(folder, {"depth", "aligned_depth", "depth_aligned", "depths", "depth_png"});
}

namespace {

/// Returns the colour images of `folder` as colours and as depths.
ImageLists findColorImages(const fs::path& folder, const VideoLayout& layout) {
  std::vector<fs::path> colors;
  const fs::path color_folder = findColorFolder(folder);
  if (!layout.color_glob.empty()) {
    colors = listMatches(folder, layout.color_glob, "--color");
  } else if (color_folder.empty()) {
    colors = listColorImages(folder);
    std::erase_if(colors, [](const fs::path& file) {
      const std::string name = toLower(file.stem().string());
      return name.find("depth") != std::string::npos || name.find("mask") != std::string::npos;
    });
  } else {
    colors = listColorImages(color_folder);
  }
  if (colors.empty())
    throw SourceError(folder.string() +
                      ": has no PNG, JPEG, WebP, BMP or PPM images; put the frames there or into "
                      "rgb/, or name them with --color 'GLOB'");
  return {colors, colors, folder.string()};
}

}  // namespace

ImageLists findImages(const fs::path& folder, const VideoLayout& layout) {
  if (layout.color_only) return findColorImages(folder, layout);
  if (layout.color_glob.empty() != layout.depth_glob.empty())
    throw SourceError("--color and --depth: each needs the other; give both, or none");
  if (!layout.color_glob.empty())
    return {listMatches(folder, layout.color_glob, "--color"),
            listMatches(folder, layout.depth_glob, "--depth"),
            (folder / layout.depth_glob).string()};
  const fs::path color_folder = findColorFolder(folder);
  const fs::path depth_folder = findDepthFolder(folder);
  if (color_folder.empty()) {
    ImageLists flat = sortFlatImages(folder);
    if (!flat.colors.empty() && !flat.depths.empty()) return flat;
    throw SourceError(folder.string() +
                      (fs::is_empty(folder) ? ": is empty" : ": has no folder rgb/ or color/") +
                      kOtherwise);
  }
  const fs::path array = depth_folder.empty() ? findDepthArray(folder) : fs::path();
  if (depth_folder.empty() && array.empty()) {
    throw SourceError(
        folder.string() +
        ": has no folder depth/; put a depth image for each colour image into it, use "
        "--depth-from with a program that estimates it, or put "
        "the depth of all frames into one array depth.npy or depth.npz");
  }
  ImageLists lists{listColorImages(color_folder), {}, depth_folder.string(), array};
  if (lists.colors.empty())
    throw SourceError(color_folder.string() +
                      ": has no PNG, JPEG, WebP, BMP or PPM images; put the frames there");
  if (!array.empty()) return lists;
  lists.depths = listDepthImages(depth_folder);
  if (!lists.depths.empty()) return lists;
  throw SourceError(
      depth_folder.string() +
      ": has no PNG, JPEG, TIFF, EXR, PGM, PFM, NPY or NPZ images; put a depth image for each "
      "colour image there");
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

}  // namespace hapticast::server
