// SPDX-License-Identifier: MIT
#include "server/source/folder/depth_folder.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/source/folder/frame_number.hpp"
#include "server/source/folder/image_lists.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

using NumberedFiles = std::map<std::uint64_t, fs::path>;

NumberedFiles numberByName(const std::vector<fs::path>& images) {
  NumberedFiles files;
  for (const fs::path& image : images) {
    const auto [first, is_new] = files.try_emplace(frameNumber(image).value(), image);
    if (is_new) continue;
    throw SourceError(image.string() + ": has the same number as " +
                      first->second.filename().string() + "; remove one of them");
  }
  return files;
}

NumberedFiles numberByOrder(const std::vector<fs::path>& images, const fs::path& folder,
                            std::optional<std::uint64_t> color_frames) {
  if (color_frames && *color_frames != images.size()) {
    throw SourceError(folder.string() + ": has " + std::to_string(images.size()) +
                      " images without frame numbers, but the colour video has " +
                      std::to_string(*color_frames) +
                      " frames; name each image by the number of its frame (000000.png)");
  }
  NumberedFiles files;
  for (std::size_t i = 0; i < images.size(); ++i) files[i] = images[i];
  return files;
}

}  // namespace

DepthFolder::DepthFolder(const fs::path& folder, std::optional<std::uint64_t> color_frames,
                         fs::path confidence)
    : folder_(folder), confidence_(std::move(confidence)) {
  const auto images = listDepthImages(folder);
  if (images.empty()) {
    throw SourceError(
        folder.string() +
        ": has no PNG, JPEG, TIFF, EXR, PGM, PFM, NPY or NPZ images; put a depth image for "
        "each colour frame there");
  }
  const bool numbered = std::all_of(images.begin(), images.end(), [](const fs::path& image) {
    return frameNumber(image).has_value();
  });
  files_ = numbered ? numberByName(images) : numberByOrder(images, folder, color_frames);
  const std::uint64_t last = files_.rbegin()->first;
  if (files_.begin()->first != 1 || !color_frames || last < *color_frames) return;
  NumberedFiles from_zero;
  for (auto& [number, file] : files_) from_zero[number - 1] = std::move(file);
  files_ = std::move(from_zero);
}

std::optional<ImageResult> DepthFolder::next() {
  if (next_ >= count()) return std::nullopt;
  const std::uint64_t frame = next_++;
  const auto found = files_.find(frame);
  if (found == files_.end())
    return ImageResult{{}, "has no image for frame " + std::to_string(frame)};
  ImageResult depth = readRawFile(found->second);
  if (depth.ok() && !confidence_.empty())
    depth.problem = applyConfidence(found->second, depth.image);
  return depth;
}

bool DepthFolder::skip() {
  if (next_ >= count()) return false;
  ++next_;
  return true;
}

std::string DepthFolder::pictureName(std::uint64_t index) const {
  const auto found = files_.find(index);
  return (found == files_.end() ? folder_ : found->second).string();
}

std::string DepthFolder::applyConfidence(const fs::path& file, cv::Mat& depth) const {
  const fs::path image = confidence_ / (file.stem().string() + ".png");
  std::error_code error;
  if (!fs::exists(image, error)) return "";
  const ImageResult confidence = readRawFile(image);
  const std::string name = "has the confidence image " + image.string() + ", which ";
  if (!confidence.ok()) return name + confidence.problem;
  if (confidence.image.type() != CV_8UC1) return name + "is not an 8-bit grey image";
  if (confidence.image.size() != depth.size()) {
    return name + "is " + sizeText(confidence.image.cols, confidence.image.rows) + ", not " +
           sizeText(depth.cols, depth.rows);
  }
  depth.setTo(0, confidence.image == 0);
  return "";
}

}  // namespace hapticast::server
