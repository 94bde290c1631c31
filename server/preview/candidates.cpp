// SPDX-License-Identifier: MIT
#include "server/preview/candidates.hpp"

#include <spdlog/spdlog.h>

#include <optional>
#include <utility>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

namespace {

/// Returns what vision makes of `frame` alone.
std::optional<PreviewFrame> startAt(const RgbdFrame& frame, const SourceInfo& info,
                                    const VisionSettings& settings) {
  Vision vision(info, settings);
  (void)vision.push(frame, MediaTime{});  // which waits for later frames
  auto results = vision.flush();
  if (results.empty()) return std::nullopt;
  VisionResult& result = results.front();
  return PreviewFrame{frame.clip_time_s, result.color, frame.depth, std::move(result.frame),
                      info.own_px};
}

/// Switches the log off while it exists.
class QuietLog {
 public:
  QuietLog() { spdlog::set_level(spdlog::level::off); }
  ~QuietLog() { spdlog::set_level(level_); }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  const spdlog::level::level_enum level_ = spdlog::get_level();
};

bool isEqualMask(const PreviewFrame& a, const PreviewFrame& b) {
  const auto mask = [](const PreviewFrame& frame) {
    cv::Mat all = cv::Mat::zeros(frame.color.size(), CV_8UC1);
    for (const std::uint32_t id : listIds(frame.haptic))
      all |= renderMask(frame.haptic, id, frame.color.size());
    return all;
  };
  return equalImages(mask(a), mask(b));
}

}  // namespace

std::vector<PreviewFrame> listCandidates(RgbdSource& source, const VisionSettings& settings) {
  std::vector<PreviewFrame> candidates;
  const SourceInfo& info = source.info();
  VisionSettings one = settings;
  std::erase_if(one.object_points, [](const AuthorPoint& point) { return point.time_s > 0.0; });
  if (info.live || info.key_masks || one.object_points.empty()) return candidates;
  one.object_points.resize(1);
  one.explain = false;
  source.rewind();
  const auto frame = source.read();
  source.rewind();
  if (!frame || !frame->mask.empty()) return candidates;
  const QuietLog quiet;  // a missing candidate is no warning here
  for (int i = 1; i <= kMostCandidates; ++i) {
    one.object_points.front().candidate = i;
    auto candidate = startAt(*frame, info, one);
    if (!candidate || (!candidates.empty() && isEqualMask(*candidate, candidates.back()))) break;
    candidates.push_back(std::move(*candidate));
  }
  return candidates;
}

}  // namespace hapticast::server
