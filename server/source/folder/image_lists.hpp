// SPDX-License-Identifier: MIT
// Finds the colour and depth images of a folder: in two folders of known names, in one folder where
// the names of the depth images have the word depth, or by the author's patterns. It decodes no
// image. Thread: any.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Images of a clip, in the order of their names. The numbers of both may differ.
struct ImageLists {
  std::vector<std::filesystem::path> colors;  ///< at least one
  std::vector<std::filesystem::path> depths;  ///< at least one, unless there is a depth_array
  std::string depth_place;                    ///< folder or pattern of the depths, for messages
  std::filesystem::path depth_array = {};     ///< file with the depth of all frames; empty: none
};

/// Returns the images in `folder`. With the patterns of `layout` they are the files that match
/// these. Otherwise they are those of a colour folder (rgb/, color/, colour/, image/, images/,
/// rgb_png/, color_png/) and a depth folder (depth/, aligned_depth/, depth_aligned/, depths/,
/// depth_png/), in capital or small letters. In place of the depth folder there may be an array
/// (depth.npy, depths.npy, depth.npz or depths.npz). Otherwise they lie in `folder` itself: the
/// names of depth images have the word depth, images whose names have the words conf or mask are
/// left out, and the others are colour. With VideoLayout::color_only the depths are the colours
/// themselves. Throws SourceError.
[[nodiscard]] ImageLists findImages(const std::filesystem::path& folder, const VideoLayout& layout);

/// Return the images in `folder`, in the order of their names. Colour images are PNG or JPEG, else
/// WebP, BMP or PPM. Depth images are PNG, JPEG, TIFF, EXR, PGM or NPY, else PFM or NPZ. Images of
/// the latter formats count only if there are no others, because a folder may have each picture in
/// two formats. Throw SourceError.
[[nodiscard]] std::vector<std::filesystem::path> listColorImages(
    const std::filesystem::path& folder);
[[nodiscard]] std::vector<std::filesystem::path> listDepthImages(
    const std::filesystem::path& folder);

/// Return the folder of the colour or depth images in `folder`, by the names of findImages().
/// Return an empty path if there is none.
[[nodiscard]] std::filesystem::path findColorFolder(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path findDepthFolder(const std::filesystem::path& folder);

/// Returns the first of `names` that is a folder in `folder`, in capital or small letters. Returns
/// an empty path if none is.
[[nodiscard]] std::filesystem::path findFolder(const std::filesystem::path& folder,
                                               std::initializer_list<const char*> names);

/// Returns whether name `a` comes before name `b`. Numbers in names are compared by value: frame2 <
/// frame10.
[[nodiscard]] bool precedesNaturally(const std::string& a, const std::string& b);

}  // namespace hapticast::server
