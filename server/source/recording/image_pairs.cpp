// SPDX-License-Identifier: MIT
#include "server/source/recording/image_pairs.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "server/source/folder/timed_images.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

// As in videos (describeTimes()): longer clips have a wrong time.
constexpr double kLongest_s = 1e6;
// Distance of the images of a pair if no step between images is known; that of TUM RGB-D.
constexpr double kUsualTolerance_s = 0.02;

/// The images of a topic in the order of time.
struct SortedImages {
  std::vector<TimedImage> times;  ///< s since the start of the clip, without files
  std::vector<McapPlace> places;
};

bool hasStamps(const ImageTopic& topic) {
  return std::all_of(topic.images.begin(), topic.images.end(),
                     [](const IndexedImage& image) { return image.stamp_ns != 0; });
}

/// Returns the images of `topic` by the time `time_ns` of each. Logs a warning if times run back.
SortedImages sortImages(const ImageTopic& topic, std::int64_t IndexedImage::*time_ns,
                        std::int64_t start_ns, const std::string& file) {
  const auto earlier = [time_ns](const IndexedImage& a, const IndexedImage& b) {
    return a.*time_ns < b.*time_ns;
  };
  std::vector<IndexedImage> images = topic.images;
  if (!std::is_sorted(images.begin(), images.end(), earlier)) {
    spdlog::warn(
        "--source {}: {} has an image with an earlier time than the image before; the server uses "
        "the images in the order of their times",
        file, topic.name);
    std::stable_sort(images.begin(), images.end(), earlier);
  }
  SortedImages sorted;
  sorted.times.reserve(images.size());
  sorted.places.reserve(images.size());
  for (const IndexedImage& image : images) {
    sorted.times.push_back({1e-9 * static_cast<double>(image.*time_ns - start_ns), {}});
    sorted.places.push_back(image.place);
  }
  return sorted;
}

std::int64_t earliest_ns(const ImageTopic& topic, std::int64_t IndexedImage::*time_ns) {
  std::int64_t least = topic.images.front().*time_ns;
  for (const IndexedImage& image : topic.images) least = std::min(least, image.*time_ns);
  return least;
}

double findTolerance_s(const SortedImages& color, const SortedImages& depth) {
  const double color_s = medianStep(color.times);
  const double depth_s = medianStep(depth.times);
  const double step_s =
      color_s > 0.0 && depth_s > 0.0 ? std::min(color_s, depth_s) : std::max(color_s, depth_s);
  return step_s > 0.0 ? 0.5 * step_s : kUsualTolerance_s;
}

/// Returns the rate of images at `times`, frames/s. It is rounded, because stamps of whole ns have
/// no rate of exactly 30.
double findRate(const std::vector<TimedImage>& times) {
  return 1e-3 * std::round(1e3 * rateOfStep(medianStep(times)));
}

}  // namespace

RecordedPairs pairImages(const TopicPair& topics, const std::string& file) {
  const bool stamped = hasStamps(*topics.color) && hasStamps(*topics.depth);
  const auto time_ns = stamped ? &IndexedImage::stamp_ns : &IndexedImage::logged_ns;
  const std::int64_t start_ns =
      std::min(earliest_ns(*topics.color, time_ns), earliest_ns(*topics.depth, time_ns));
  const SortedImages color = sortImages(*topics.color, time_ns, start_ns, file);
  const SortedImages depth = sortImages(*topics.depth, time_ns, start_ns, file);
  const double tolerance_s = findTolerance_s(color, depth);
  const auto partners = pairNearest(color.times, depth.times, tolerance_s);
  std::vector<TimedImage> paired;
  RecordedPairs out;
  for (std::size_t i = 0; i < partners.size(); ++i) {
    if (!partners[i]) continue;
    out.pairs.push_back({0, color.places[i], depth.places[*partners[i]]});
    paired.push_back(color.times[i]);
  }
  if (out.pairs.empty()) {
    throw SourceError(fmt::format(
        "{}: no image of {} is within {:.0f} ms of an image of {}; both need the same clock", file,
        topics.depth->name, 1e3 * tolerance_s, topics.color->name));
  }
  if (paired.back().time - paired.front().time > kLongest_s)
    throw SourceError(file + ": the times of its images span more than 11 days; correct them");
  if (out.pairs.size() < color.times.size() || out.pairs.size() < depth.times.size()) {
    spdlog::warn(
        "--source {}: pairs images by their times; {} colour images have no depth, and {} depth "
        "images no colour",
        file, color.times.size() - out.pairs.size(), depth.times.size() - out.pairs.size());
  }
  out.fps = findRate(paired);
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < paired.size(); ++i) {
    const double time_s = paired[i].time - paired.front().time;
    next = std::max(next, static_cast<std::uint64_t>(std::llround(time_s * out.fps)));
    out.pairs[i].index = next++;
  }
  return out;
}

}  // namespace hapticast::server
