// SPDX-License-Identifier: MIT
#include "server/source/folder/image_sequence.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

#include "server/source/scale/depth_scale.hpp"
#include "server/source/scale/picture_scale.hpp"

namespace hapticast::server {

namespace {

/// Returns the depth format, from the declarations and `first`, the first depth image.
DepthFormat detectFormat(const std::filesystem::path& file, const cv::Mat& first,
                         const ClipFiles& clip) {
  const int bits = static_cast<int>(8 * first.elemSize1());
  constexpr double kMm_m = 1000.0;  // estimators and simulators write metres
  if (first.depth() == CV_32F) return {DepthKind::kMetric, clip.mm_per_unit.value_or(kMm_m)};
  const int declared = clip.declared_depth_bits.value_or(bits);
  if (bits != declared) {
    throw SourceError(file.string() + ": depth has " + std::to_string(bits) + " bits where " +
                      std::to_string(declared) + " are declared; " +
                      (declared == 16 ? "save it as 16-bit grey PNG, or set \"depth_bits\": 8"
                                      : "save it as 8-bit grey, or set \"depth_bits\": 16") +
                      " in meta.json");
  }
  if (isColorCoded(first)) {
    throw SourceError(
        file.string() +
        ": shows depth as colours; save it as grey (8 bit, near is white) or as 16-bit "
        "PNG in millimetres");
  }
  return {bits == 16 ? DepthKind::kMetric : DepthKind::kHeight, clip.mm_per_unit.value_or(1.0)};
}

}  // namespace

ImageSequence::ImageSequence(const std::filesystem::path& folder, double fps, bool to_and_fro,
                             const VideoLayout& layout)
    : files_(findClipFiles(folder, layout)), layout_(layout) {
  if (!files_.depth_array.empty()) openArray(to_and_fro);
  if (to_and_fro && files_.frames.size() > 2) {
    const std::vector<FrameFiles> back(files_.frames.rbegin() + 1, files_.frames.rend() - 1);
    files_.frames.insert(files_.frames.end(), back.begin(), back.end());
  }
  // A gap has no depth.
  const auto whole = std::find_if(
      files_.frames.begin(), files_.frames.end(),
      [this](const FrameFiles& frame) { return layout_.color_only || !frame.depth.empty(); });
  describe(folder, *whole);
  info_.fps = fps > 0.0 ? fps : files_.fps;
  info_.frame_count = files_.frames.size();
  info_.key_masks = files_.key_masks;
  if (files_.camera) info_.camera = scaleCamera(*files_.camera, info_);
  if (!info_.camera && files_.fov_deg)
    info_.camera = CameraModel::ofFieldOfView(*files_.fov_deg, info_.width_px, info_.height_px);
  if (info_.key_masks) checkKeyMasks();
  RgbdFrame frame;
  const auto index = static_cast<std::uint64_t>(whole - files_.frames.begin());
  if (const std::string problem = load(index, frame); !problem.empty())
    throw SourceError(problem + "; mend this first frame");
}

void ImageSequence::describe(const std::filesystem::path& folder, const FrameFiles& first) {
  const ImageResult color = readColorFile(first.color);
  if (!color.ok())
    throw SourceError(first.color.string() + ": " + color.problem + "; mend this first frame");
  info_.name = fileName(folder);
  own_size_ = color.image.size();
  setSize(info_, own_size_, folder.string());
  warnOfOtherSize(folder);
  if (!layout_.color_only) describeDepth(folder, first);
}

void ImageSequence::describeDepth(const std::filesystem::path& folder, const FrameFiles& first) {
  const ImageResult depth = readRawDepth(first);
  if (!depth.ok())
    throw SourceError(first.depth.string() + ": " + depth.problem + "; mend this first frame");
  format_ = detectFormat(first.depth, depth.image, files_);
  if (layout_.code == DepthCode::kInverse && format_.kind == DepthKind::kMetric)
    throw SourceError(first.depth.string() +
                      ": has depth in mm, so leave --depth-near and --depth-code out");
  setDepthUnit(format_, layout_.depth_unit_mm, first.depth.string());
  chooseDepthSize(folder, depth.image);
  info_.depth_kind = format_.kind;
  info_.mm_per_unit =
      layout_.depth_unit_mm.value_or(first.mm_per_unit.value_or(format_.mm_per_unit));
}

void ImageSequence::chooseDepthSize(const std::filesystem::path& folder, const cv::Mat& first) {
  depth_size_ = isSameAspect(first.size(), own_size_) ? first.size() : own_size_;
  if (depth_size_ != own_size_) logScaledDepth(folder.string(), depth_size_, frameSize(info_));
}

void ImageSequence::warnOfOtherSize(const std::filesystem::path& folder) const {
  const int width_px = files_.declared_width_px.value_or(own_size_.width);
  const int height_px = files_.declared_height_px.value_or(own_size_.height);
  if (cv::Size(width_px, height_px) == own_size_) return;
  spdlog::warn(
      "--source {}: states {}, but the pictures are {}; the server uses the intrinsics as those of "
      "the pictures, "
      "so correct width and height, and give fx, fy, cx and cy for the size of the pictures",
      (folder / "meta.json").string(), sizeText(width_px, height_px),
      sizeText(own_size_.width, own_size_.height));
}

std::optional<RgbdFrame> ImageSequence::read() {
  while (next_ < files_.frames.size()) {
    const std::uint64_t index = next_++;
    RgbdFrame frame;
    const std::string problem = load(index, frame);
    if (problem.empty()) {
      skipped_.endRun();
      any_read_ = true;
      return frame;
    }
    skipped_.add(index, problem);
  }
  const bool has_run = !skipped_.problem().empty();
  if (has_run && (!any_read_ || hasVanished(files_.frames.back())))
    throw SourceError(skipped_.cancelRun() +
                      ", and no frame after it can be read either; put the files back");
  skipped_.endRun();
  return std::nullopt;
}

bool ImageSequence::hasVanished(const FrameFiles& frame) {
  std::error_code error;
  return !std::filesystem::exists(frame.color, error) ||
         (!frame.depth.empty() && !std::filesystem::exists(frame.depth, error));
}

bool ImageSequence::skip() {
  if (next_ >= files_.frames.size()) return false;
  ++next_;
  return true;
}

void ImageSequence::rewind() {
  next_ = 0;
  any_read_ = false;
  ++epoch_;
}

void ImageSequence::checkKeyMasks() const {
  for (const FrameFiles& frame : files_.frames) {
    if (frame.mask.empty()) continue;
    const ImageResult mask = readMask(frame.mask);
    if (!mask.ok()) throw SourceError(frame.mask.string() + ": " + mask.problem + "; mend it");
    if (cv::countNonZero(mask.image) == 0) {
      throw SourceError(frame.mask.string() +
                        ": shows no object; draw it in white on black, or remove this key mask");
    }
  }
}

ImageResult ImageSequence::readMask(const std::filesystem::path& file) const {
  ImageResult mask = readRawFile(file);
  if (mask.ok()) mask = toMask(mask.image);
  if (mask.ok()) mask.problem = otherSize(mask.image);
  if (mask.ok()) mask.image = scaleMask(mask.image, frameSize(info_));
  return mask;
}

ImageResult ImageSequence::joinMasks(const std::vector<std::filesystem::path>& files) const {
  cv::Mat joined = cv::Mat::zeros(own_size_, CV_8UC1);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].empty()) continue;
    ImageResult mask = readRawFile(files[i]);
    if (mask.ok()) mask.problem = otherSize(mask.image);
    if (mask.ok() && mask.image.type() != CV_8UC1) mask.problem = "is not an 8-bit grey image";
    if (!mask.ok()) return {{}, files[i].string() + ": " + mask.problem};
    joined.setTo(static_cast<double>(i + 1), mask.image >= 128);
  }
  return {scaleMask(joined, frameSize(info_)), ""};
}

ImageResult ImageSequence::readColor(const std::filesystem::path& file) const {
  ImageResult color = readColorFile(file);
  if (color.ok()) color.problem = otherSize(color.image);
  if (color.ok()) color.image = scaleColor(color.image, frameSize(info_));
  return color;
}

void ImageSequence::openArray(bool to_and_fro) {
  array_ = std::make_unique<NpyStack>(files_.depth_array);
  if (to_and_fro && !array_->seeksBackwards())
    throw SourceError(
        files_.depth_array.string() +
        ": is compressed, so it cannot play --to-and-fro; save it without compression "
        "(numpy: np.save)");
}

ImageResult ImageSequence::readRawDepth(const FrameFiles& files) const {
  if (!array_) return readRawFile(files.depth);
  array_->seek(files.array_index);
  return array_->next().value_or(ImageResult{{}, "has lost pictures"});
}

ImageResult ImageSequence::readDepth(const FrameFiles& files, const cv::Mat& color) const {
  DepthFormat format = format_;
  if (!layout_.depth_unit_mm) format.mm_per_unit = files.mm_per_unit.value_or(format.mm_per_unit);
  ImageResult depth = readRawDepth(files);
  if (depth.ok()) depth = toDepth(depth.image, format);
  if (!depth.ok()) return depth;
  if (layout_.code == DepthCode::kInverse) depth.image = 255.0F - depth.image;
  const cv::Size size = depth.image.size();
  if (size != depth_size_) {
    const bool is_own = depth_size_ == own_size_;
    const bool other_aspect = is_own && !isSameAspect(size, own_size_);
    return {{},
            "is " + sizeText(size.width, size.height) + ", but the clip's " +
                (is_own ? "colour" : "depth") + " is " +
                sizeText(depth_size_.width, depth_size_.height) +
                (other_aspect ? aspectRemedy(size, own_size_) : "")};
  }
  depth.image = scaleDepth(depth.image, format_.kind, color);
  return depth;
}

std::string ImageSequence::otherSize(const cv::Mat& image) const {
  if (image.size() == own_size_) return "";
  return "is " + sizeText(image.cols, image.rows) + ", but the clip's colour is " +
         sizeText(own_size_.width, own_size_.height);
}

std::string ImageSequence::load(std::uint64_t index, RgbdFrame& frame) const {
  const FrameFiles& files = files_.frames[index];
  if (files.depth.empty() && !layout_.color_only)
    return files.color.string() + ": has no depth image";
  const ImageResult color = readColor(files.color);
  if (!color.ok()) return files.color.string() + ": " + color.problem;
  const ImageResult depth = layout_.color_only ? ImageResult() : readDepth(files, color.image);
  if (!depth.ok()) return files.depth.string() + ": " + depth.problem;
  ImageResult mask;
  if (!files.mask.empty()) mask = readMask(files.mask);
  if (!mask.ok()) return files.mask.string() + ": " + mask.problem;
  if (!files.object_masks.empty()) mask = joinMasks(files.object_masks);
  if (!mask.ok()) return mask.problem;
  frame = {index,       epoch_,      static_cast<double>(index) / info_.fps,
           color.image, depth.image, mask.image};
  return "";
}

}  // namespace hapticast::server
