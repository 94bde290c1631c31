// SPDX-License-Identifier: MIT
#include "server/vision/vision.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/library/frame_export.hpp"
#include "common/library/frame_import.hpp"
#include "common/library/require.hpp"
#include "common/wire_limits.hpp"
#include "server/library/member_names.hpp"
#include "server/library/vision/images.hpp"
#include "server/library/vision/source_impl.hpp"
#include "server/vision/describe.hpp"

namespace hapticast {

namespace {

constexpr int kJpegQuality = 80;       // as the server
constexpr double kMostDepth_mm = 1e6;  // as --map-range of the server
constexpr double kSamePlace_px = 3.0;  // chosen: precision of a pointing person
constexpr double kMost_s = 1e-9 * static_cast<double>(limits::kTime_ns);

std::string describePoint(const char* what, const std::pair<double, double>& point) {
  return std::string(what) + ": (" + std::to_string(point.first) + ", " +
         std::to_string(point.second) + ")";
}

std::vector<server::AuthorPoint> importPoints(const std::vector<std::pair<double, double>>& points,
                                              const char* what, const server::SourceInfo& info) {
  std::vector<server::AuthorPoint> to;
  for (const auto& point : points) {
    require(point.first >= 0.0 && point.first < info.width_px && point.second >= 0.0 &&
                point.second < info.height_px,
            describePoint(what, point) + " is outside the images of " +
                std::to_string(info.width_px) + " x " + std::to_string(info.height_px) + " px");
    to.push_back({{point.first, point.second}, 0.0, 0});
  }
  return to;
}

/// Throws std::invalid_argument if a point is on an object and on none.
void checkContradictions(const VisionSettings& settings) {
  for (const auto& on : settings.objects) {
    for (const auto& off : settings.not_objects) {
      require(std::hypot(on.first - off.first, on.second - off.second) >= kSamePlace_px,
              describePoint("objects", on) + " is less than 3 px from a point of not_objects");
    }
  }
}

std::optional<server::DepthRange> importRange(
    const std::optional<std::pair<double, double>>& range) {
  if (!range) return std::nullopt;
  require(range->first >= 0.0 && range->first < range->second && range->second <= kMostDepth_mm,
          describePoint("map_range", *range) + " is no range; use 0 <= near < far <= 1000000 mm");
  return server::DepthRange{range->first, range->second};
}

server::VisionSettings importSettings(const VisionSettings& settings,
                                      const server::SourceInfo& info) {
  server::VisionSettings to;
  to.method = settings.thesis ? Method::kThesis : Method::kHapticast;
  to.motion = settings.motion ? server::MotionMode::kAuto : server::MotionMode::kNone;
  to.object_points = importPoints(settings.objects, "objects", info);
  to.not_points = importPoints(settings.not_objects, "not_objects", info);
  checkContradictions(settings);
  to.map_range = importRange(settings.map_range);
  if (settings.fov_deg) {
    require(*settings.fov_deg >= 10.0 && *settings.fov_deg <= 170.0,
            "fov_deg: " + std::to_string(*settings.fov_deg) + " is outside 10..170");
  }
  to.fov_deg = settings.fov_deg;
  to.low_latency = settings.low_latency;
  to.threads = 1;  // the caller's program has its own threads
  to.material = importMaterial(settings.material);
  to.mass_kg = std::exchange(to.material.mass_kg, std::nullopt);
  return to;
}

}  // namespace

class Vision::Impl {
 public:
  Impl(const server::SourceInfo& info, const VisionSettings& settings, bool of_source)
      : info_(info),
        of_source_(of_source),
        pictures_(settings.pictures),
        vision_(info_, importSettings(settings, info_)) {}

  void scan(server::RgbdSource& source);
  [[nodiscard]] StreamInfo info() const { return exportInfo(vision_.description()); }
  std::optional<Frame> push(const Images& images);
  std::vector<Frame> flush();

 private:
  /// Which vectors of the images are not empty.
  struct Content {
    bool rgb = false;
    bool mask = false;
  };

  [[nodiscard]] MediaTime checkTime(double time_s) const;
  void checkContent(const Content& content) const;
  [[nodiscard]] server::RgbdFrame makeFrame(const Images& images) const;
  [[nodiscard]] Frame convert(const server::VisionResult& result);
  /// Calls `work`. After an error the next images begin anew.
  template <class Work>
  auto guard(Work work);

  server::SourceInfo info_;
  bool of_source_;
  bool pictures_;
  server::Vision vision_;
  FrameExporter exporter_;
  std::optional<MediaTime> last_time_;
  std::optional<Content> content_;  // of the first images
  std::uint64_t next_index_ = 0;
  std::uint32_t epoch_ = 0;
  double epoch_begin_s_ = 0.0;
};

template <class Work>
auto Vision::Impl::guard(Work work) {
  try {
    return work();
  } catch (const server::SourceError& error) {
    vision_.beginAnew();
    throw std::runtime_error(nameMembers(error.what()));
  } catch (const cv::Exception& error) {
    vision_.beginAnew();
    throw std::runtime_error("OpenCV: " + error.err);
  }
}

void Vision::Impl::scan(server::RgbdSource& source) {
  (void)guard([&] { return vision_.scan(source, nullptr); });
}

MediaTime Vision::Impl::checkTime(double time_s) const {
  require(std::abs(time_s) <= kMost_s,
          "time_s: " + std::to_string(time_s) + " is outside +-" + std::to_string(kMost_s));
  const MediaTime time = mediaTime(time_s);
  require(!last_time_ || time > *last_time_,
          "time_s: " + std::to_string(time_s) + " s does not rise; the images before had " +
              std::to_string(last_time_ ? toSeconds(*last_time_) : 0.0) + " s");
  return time;
}

void Vision::Impl::checkContent(const Content& content) const {
  if (!content_) return;
  require(content.rgb == content_->rgb, "rgb: some images have a picture, others have none");
  require(content.mask == content_->mask || info_.key_masks,
          "mask: some images have a mask, others have none");
}

server::RgbdFrame Vision::Impl::makeFrame(const Images& images) const {
  server::RgbdFrame frame = importImages(images);
  if (!of_source_) frame.index = next_index_;
  const bool begins = !last_time_ || images.epoch != epoch_;
  frame.clip_time_s = begins ? 0.0 : images.time_s - epoch_begin_s_;
  return frame;
}

std::optional<Frame> Vision::Impl::push(const Images& images) {
  const MediaTime time = checkTime(images.time_s);
  checkImages(images, info_);
  const Content content{!images.rgb.empty(), !images.mask.empty()};
  checkContent(content);
  const server::RgbdFrame frame = makeFrame(images);
  const auto result = guard([&] { return vision_.push(frame, time); });
  if (!last_time_ || images.epoch != epoch_) epoch_begin_s_ = images.time_s;
  epoch_ = images.epoch;
  last_time_ = time;
  content_ = content_.value_or(content);
  ++next_index_;
  return result ? std::optional(convert(*result)) : std::nullopt;
}

std::vector<Frame> Vision::Impl::flush() {
  const auto results = guard([this] { return vision_.flush(); });
  std::vector<Frame> frames;
  frames.reserve(results.size());
  for (const server::VisionResult& each : results) frames.push_back(convert(each));
  return frames;
}

Frame Vision::Impl::convert(const server::VisionResult& result) {
  Frame frame = exporter_.convert(result.frame);
  if (pictures_ && content_ && content_->rgb)
    frame.jpeg = server::encodePicture(result.color, kJpegQuality);
  return frame;
}

Vision::Vision(const SourceInfo& info, const VisionSettings& settings)
    : impl_(std::make_unique<Impl>(importSourceInfo(info), settings, false)) {}

Vision::Vision(Source& source, const VisionSettings& settings)
    : impl_(std::make_unique<Impl>(source.impl_->inner().info(), settings, true)) {
  if (source.info().live) return;
  if (source.impl_->hasBegun()) source.rewind();
  impl_->scan(source.impl_->inner());
}

Vision::~Vision() = default;
Vision::Vision(Vision&& from) noexcept = default;
Vision& Vision::operator=(Vision&& from) noexcept = default;

StreamInfo Vision::info() const { return impl_->info(); }
std::optional<Frame> Vision::push(const Images& images) { return impl_->push(images); }
std::vector<Frame> Vision::flush() { return impl_->flush(); }

}  // namespace hapticast
