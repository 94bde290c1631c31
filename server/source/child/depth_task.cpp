// SPDX-License-Identifier: MIT
#include "server/source/child/depth_task.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "common/text.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/source/scale/depth_scale.hpp"

namespace hapticast::server {

namespace {

static_assert(std::endian::native == std::endian::little,
              "float32 of the answers is little-endian");

// Chosen: networks resize a picture to multiples of 14 or 32 px, so its sides differ.
constexpr double kSameAspect = 0.06;
constexpr double kNearShare = 0.98;
constexpr double kFarShare = 0.02;
constexpr double kBeyond = 10.0;

constexpr std::array<std::pair<std::string_view, EstimatedDepth>, 3> kKinds{
    {{"metric_mm", EstimatedDepth::kMetric},
     {"relative", EstimatedDepth::kRelative},
     {"inverse", EstimatedDepth::kInverse}}};

/// Returns the smallest and the largest value between the given shares of the finite values.
std::pair<double, double> findSpread(const cv::Mat& values) {
  std::vector<float> finite;
  finite.reserve(values.total());
  for (int v = 0; v < values.rows; ++v) {
    const auto* row = values.ptr<float>(v);
    std::copy_if(row, row + values.cols, std::back_inserter(finite),
                 [](float value) { return std::isfinite(value); });
  }
  if (finite.empty()) return {0.0, 0.0};
  const auto select = [&finite](double share) {
    const auto at = finite.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), at, finite.end());
    return static_cast<double>(*at);
  };
  const double low = select(kFarShare);
  return {low, select(kNearShare)};
}

}  // namespace

std::optional<DepthHeader> parseDepthHeader(const std::string& line) {
  std::istringstream words(line);
  DepthHeader header;
  std::string kind;
  std::string rest;
  if (!(words >> header.width_px >> header.height_px >> kind) || words >> rest) return std::nullopt;
  const bool allowed = header.width_px >= 1 && header.width_px <= kMostAnswerSide_px &&
                       header.height_px >= 1 && header.height_px <= kMostAnswerSide_px;
  const auto* const found = std::find_if(kKinds.begin(), kKinds.end(),
                                         [&kind](const auto& each) { return each.first == kind; });
  if (!allowed || found == kKinds.end()) return std::nullopt;
  header.kind = found->second;
  return header;
}

void writeRgb(const cv::Mat& color, std::uint8_t* to) {
  cv::Mat rgb(color.size(), CV_8UC3, to);
  cv::cvtColor(color, rgb, cv::COLOR_BGR2RGB);
}

std::vector<std::uint8_t> encodePpm(const cv::Mat& color) {
  const std::string header =
      "P6\n" + std::to_string(color.cols) + " " + std::to_string(color.rows) + "\n255\n";
  std::vector<std::uint8_t> bytes(header.size() + 3 * color.total());
  std::copy(header.begin(), header.end(), bytes.begin());
  writeRgb(color, bytes.data() + header.size());
  return bytes;
}

RelativeDepthMap::RelativeDepthMap(const cv::Mat& values, EstimatedDepth kind,
                                   const DepthRange& range)
    : inverse_(kind == EstimatedDepth::kInverse), range_(range) {
  const auto [low, high] = findSpread(values);
  const double from = inverse_ ? 1.0 / range.far_mm : range.near_mm;
  const double to = inverse_ ? 1.0 / range.near_mm : range.far_mm;
  // A picture with one value lies in the middle.
  scale_ = high > low ? (to - from) / (high - low) : 0.0;
  shift_ = high > low ? from - scale_ * low : 0.5 * (from + to);
}

cv::Mat RelativeDepthMap::convert(const cv::Mat& values) const {
  cv::Mat out(values.size(), CV_32FC1);
  const double least = range_.near_mm / kBeyond;
  const double most = range_.far_mm * kBeyond;
  for (int v = 0; v < values.rows; ++v) {
    const auto* from = values.ptr<float>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; u < values.cols; ++u) {
      const double value = scale_ * double(from[u]) + shift_;
      const double depth = inverse_ ? 1.0 / std::max(value, 1.0 / most) : value;
      to[u] = std::isfinite(from[u]) ? static_cast<float>(std::clamp(depth, least, most)) : 0.0F;
    }
  }
  return out;
}

std::optional<std::size_t> DepthTask::measure(const std::string& header) const {
  const auto parsed = parseDepthHeader(header);
  if (!parsed) return std::nullopt;
  return sizeof(float) * static_cast<std::size_t>(parsed->width_px) *
         static_cast<std::size_t>(parsed->height_px);
}

bool DepthTask::recall(RgbdFrame& frame) {
  if (cache_ == nullptr) return false;
  const auto answer = cache_->load(frame.index);
  return answer && measure(answer->header) == answer->bytes.size() &&
         setDepth(frame, *answer).empty();
}

std::string DepthTask::apply(RgbdFrame& frame, const ChildAnswer& answer) {
  std::string problem = setDepth(frame, answer);
  if (problem.empty() && cache_ != nullptr) cache_->store(frame.index, answer);
  return problem;
}

std::string DepthTask::setDepth(RgbdFrame& frame, const ChildAnswer& answer) {
  const DepthHeader header = parseDepthHeader(answer.header).value_or(DepthHeader{});
  if (kind_ && header.kind != *kind_) return "changes the kind of its depth";
  const cv::Size size(header.width_px, header.height_px);
  const double aspect = static_cast<double>(size.width) * frame.color.rows /
                        (static_cast<double>(size.height) * frame.color.cols);
  if (std::abs(std::log(aspect)) > kSameAspect)
    return "answers with depth of " + sizeText(size.width, size.height) + " for a picture of " +
           sizeText(frame.color.cols, frame.color.rows) + ", which has another shape";
  cv::Mat depth(size, CV_32FC1);
  std::memcpy(depth.data, answer.bytes.data(), answer.bytes.size());
  kind_ = header.kind;
  if (header.kind == EstimatedDepth::kMetric) {
    depth = toDepth(depth, {}).image;  // what is no depth becomes 0
  } else {
    if (!map_) map_.emplace(depth, header.kind, range_);
    depth = map_->convert(depth);
  }
  frame.depth = scaleDepth(depth, DepthKind::kMetric, frame.color);
  return "";
}

void DepthTask::describe(SourceInfo& info) const {
  info.depth_kind = DepthKind::kMetric;
  info.mm_per_unit = 1.0;
  info.estimated = kind_.value_or(EstimatedDepth::kMetric);
}

}  // namespace hapticast::server
