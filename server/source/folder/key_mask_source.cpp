// SPDX-License-Identifier: MIT
#include "server/source/folder/key_mask_source.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <utility>

#include "server/source/picture/image_file.hpp"
#include "server/source/scale/picture_scale.hpp"

namespace hapticast::server {

namespace {

[[noreturn]] void throwMaskError(const KeyMaskFile& mask, const std::string& what) {
  throw SourceError("--scene: key mask " + mask.file + ": " + what);
}

/// Returns the mask of one object, 0/255, from a picture file.
cv::Mat readObjectMask(const KeyMaskFile& file, const SourceInfo& info) {
  const ImageResult raw = readRawFile(file.file);
  if (!raw.ok()) throwMaskError(file, raw.problem + "; mend it");
  const ImageResult labels = toMask(raw.image);
  if (!labels.ok()) throwMaskError(file, labels.problem + "; draw it in white on black");
  const cv::Size own = ownSize(info);
  if (labels.image.size() != own) {
    throwMaskError(file, fmt::format("is {}, but the pictures are {}; draw it at their size",
                                     sizeText(labels.image.cols, labels.image.rows),
                                     sizeText(own.width, own.height)));
  }
  cv::Mat mask = scaleMask(labels.image, frameSize(info)) > 0;
  if (cv::countNonZero(mask) == 0)
    throwMaskError(file, "shows no object; draw it in white on black");
  return mask;
}

}  // namespace

KeyMaskSource::KeyMaskSource(std::unique_ptr<RgbdSource> source,
                             const std::vector<KeyMaskFile>& masks)
    : source_(std::move(source)), info_(source_->info()) {
  if (info_.live)
    throw SourceError("--scene: a live source has no key masks; remove them from the scene file");
  if (!info_.key_masks) {
    const std::optional<RgbdFrame> first = source_->read();
    source_->rewind();
    if (first && !first->mask.empty()) {
      throw SourceError("--scene: " + info_.name +
                        " has masks of its own for all frames; remove the key masks");
    }
  }
  info_.key_masks = true;
  for (const KeyMaskFile& mask : masks) add(mask);
}

void KeyMaskSource::add(const KeyMaskFile& mask) {
  const auto index = static_cast<std::uint64_t>(std::llround(mask.time_s * info_.fps));
  if (info_.frame_count && index >= *info_.frame_count) {
    throwMaskError(mask, fmt::format("its time {:g} s is after the end of the clip, which lasts "
                                     "{:.4g} s; correct \"time\"",
                                     mask.time_s, double(*info_.frame_count) / info_.fps));
  }
  readObjectMask(mask, info_);
  masks_[index].push_back(mask);
}

cv::Mat KeyMaskSource::draw(const std::vector<KeyMaskFile>& masks) const {
  cv::Mat labels = cv::Mat::zeros(info_.height_px, info_.width_px, CV_8UC1);
  for (const KeyMaskFile& mask : masks) labels.setTo(mask.number, readObjectMask(mask, info_));
  return labels;
}

std::optional<RgbdFrame> KeyMaskSource::read() {
  std::optional<RgbdFrame> frame = source_->read();
  if (!frame) return frame;
  const auto masks = masks_.find(frame->index);
  if (masks != masks_.end()) frame->mask = draw(masks->second);
  return frame;
}

std::unique_ptr<RgbdSource> addKeyMasks(std::unique_ptr<RgbdSource> source,
                                        const std::vector<KeyMaskFile>& masks) {
  if (masks.empty()) return source;
  return std::make_unique<KeyMaskSource>(std::move(source), masks);
}

}  // namespace hapticast::server
