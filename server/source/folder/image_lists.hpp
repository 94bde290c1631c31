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
  std::vector<std::filesystem::path> depths;  ///< at least one
  std::string depth_place;                    ///< folder or pattern of the depths, for messages
};

/// Returns the images in `folder`. With the patterns of `layout` they are the files that match
/// these. Otherwise they are those of a colour folder (rgb/, color/, colour/, image/, images/,
/// rgb_png/, color_png/) and a depth folder (depth/, aligned_depth/, depth_aligned/, depths/,
/// depth_png/), in capital or small letters. Otherwise they lie in `folder` itself: the names of
/// depth images have the word depth, images whose names have the words conf or mask are left out,
/// and the others are colour. Throws SourceError.
[[nodiscard]] ImageLists findImages(const std::filesystem::path& folder, const VideoLayout& layout);

/// Returns the colour images (PNG or JPEG) in `folder`, in the order of their names. Throws
/// SourceError.
[[nodiscard]] std::vector<std::filesystem::path> listColorImages(
    const std::filesystem::path& folder);

/// Returns the first of `names` that is a folder in `folder`, in capital or small letters. Returns
/// an empty path if none is.
[[nodiscard]] std::filesystem::path findFolder(const std::filesystem::path& folder,
                                               std::initializer_list<const char*> names);

/// Returns whether name `a` comes before name `b`. Numbers in names are compared by value: frame2 <
/// frame10.
[[nodiscard]] bool precedesNaturally(const std::string& a, const std::string& b);

}  // namespace hapticast::server
