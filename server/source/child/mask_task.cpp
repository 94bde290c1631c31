// SPDX-License-Identifier: MIT
#include "server/source/child/mask_task.hpp"

#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "common/haptic_frame.hpp"
#include "server/source/child/depth_task.hpp"
#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostKept_bytes = std::size_t{256}
                                        << 20U;  // chosen: of some 100,000 usual masks

}  // namespace

std::vector<std::uint8_t> encodeMaskRequest(const RgbdFrame& frame,
                                            const std::vector<MaskPoint>& points) {
  nlohmann::json line{{"frame", frame.index},
                      {"time_s", frame.clip_time_s},
                      {"width", frame.color.cols},
                      {"height", frame.color.rows},
                      {"points", nlohmann::json::array()}};
  for (const MaskPoint& point : points) {
    if (point.time_s > frame.clip_time_s) continue;
    line["points"].push_back({{"object", point.object},
                              {"u", point.at_px.x()},
                              {"v", point.at_px.y()},
                              {"time_s", point.time_s}});
  }
  const std::string header = line.dump() + "\n";
  const std::size_t pixels = frame.color.total();
  std::vector<std::uint8_t> bytes(header.size() + pixels * (3 + sizeof(float)));
  std::copy(header.begin(), header.end(), bytes.begin());
  writeRgb(frame.color, bytes.data() + header.size());
  std::uint8_t* to = bytes.data() + header.size() + 3 * pixels;
  for (int v = 0; v < frame.depth.rows; ++v) {
    const std::size_t row_bytes = sizeof(float) * static_cast<std::size_t>(frame.depth.cols);
    std::memcpy(to, frame.depth.ptr(v), row_bytes);
    to += row_bytes;
  }
  return bytes;
}

std::optional<cv::Size> parseMaskHeader(const std::string& line) {
  std::istringstream words(line);
  cv::Size size;
  std::string rest;
  if (!(words >> size.width >> size.height) || words >> rest) return std::nullopt;
  const bool none = size.width == 0 && size.height == 0;
  const bool allowed = size.width >= 1 && size.width <= kMostAnswerSide_px && size.height >= 1 &&
                       size.height <= kMostAnswerSide_px;
  return none || allowed ? std::optional(size) : std::nullopt;
}

std::optional<std::size_t> MaskTask::measure(const std::string& header) const {
  const auto size = parseMaskHeader(header);
  if (!size) return std::nullopt;
  return static_cast<std::size_t>(size->width) * static_cast<std::size_t>(size->height);
}

bool MaskTask::recall(RgbdFrame& frame) {
  const auto kept = kept_.find(frame.index);
  if (kept == kept_.end()) return false;
  frame.mask = kept->second.empty() ? cv::Mat() : cv::imdecode(kept->second, cv::IMREAD_GRAYSCALE);
  return true;
}

std::string MaskTask::apply(RgbdFrame& frame, const ChildAnswer& answer) {
  const cv::Size size = parseMaskHeader(answer.header).value_or(cv::Size());
  frame.mask = cv::Mat();
  std::string problem;
  if (!size.empty() && size != frame.color.size()) {
    problem = "answers with a mask of " + sizeText(size.width, size.height) + " for a picture of " +
              sizeText(frame.color.cols, frame.color.rows);
  } else if (!size.empty()) {
    cv::Mat mask(size, CV_8UC1);
    std::memcpy(mask.data, answer.bytes.data(), answer.bytes.size());
    double most = 0.0;
    cv::minMaxLoc(mask, nullptr, &most);
    if (most > static_cast<double>(kMaxObjects)) {
      problem = "answers with the value " + std::to_string(static_cast<int>(most)) +
                ", but objects have the numbers 1 to " + std::to_string(kMaxObjects);
    } else if (most > 0.0) {
      frame.mask = mask;
    }
  }
  if (problem.empty()) remember(frame.index, frame.mask);
  return problem;
}

void MaskTask::remember(std::uint64_t index, const cv::Mat& mask) {
  if (live_ || (folder_ == nullptr && kept_bytes_ > kMostKept_bytes)) return;
  std::vector<std::uint8_t> png;
  if (!mask.empty()) cv::imencode(".png", mask, png);
  if (folder_ != nullptr) folder_->store(index, png);
  if (kept_bytes_ > kMostKept_bytes) return;
  const std::size_t bytes = png.size();
  if (kept_.insert_or_assign(index, std::move(png)).second) kept_bytes_ += bytes;
}

}  // namespace hapticast::server
