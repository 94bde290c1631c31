// SPDX-License-Identifier: MIT
#include "server/vision/surface/layer_cutter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr double kKeptStep = 0.7;  // chosen, of the step that caused a cut: limit to remove the cut
// Chosen, frames: noise of fur gives a name for three to five frames in a row.
constexpr int kVoteFrames = 8;
constexpr int kLead = 85;          // chosen, of 255 votes: by which another name has to lead
constexpr int kFollows_px = 2;     // chosen: motion of an edge in a frame relative to its surface
constexpr int kBeside_px = 9;      // chosen: window of the mean depth of a layer beside its edge
constexpr double kClearly = 0.25;  // chosen, of a step: by which a depth is nearer to one layer
constexpr int kCrumb_px = 30;      // chosen: smaller rests of a name are removed
constexpr double kCrumbShare = 0.005;  // chosen, of the object; likewise

using Votes = cv::Vec<uchar, kMaxLayers>;

// Returns every `reduction`-th pixel of a surface, on a lattice that is fixed in the picture.
Surface sampleSurface(const Surface& surface, int reduction) {
  const cv::Rect& full = surface.box;
  const cv::Point first(full.x / reduction, full.y / reduction);
  const cv::Point end((full.br().x + reduction - 1) / reduction,
                      (full.br().y + reduction - 1) / reduction);
  Surface out;
  out.box = cv::Rect(first, end);
  out.mask = cv::Mat::zeros(out.box.size(), CV_8UC1);
  out.measured = cv::Mat::zeros(out.box.size(), CV_8UC1);
  out.depth = cv::Mat::zeros(out.box.size(), CV_32FC1);
  for (int v = 0; v < out.box.height; ++v) {
    const int from_v = (v + first.y) * reduction + reduction / 2 - full.y;
    if (from_v < 0 || from_v >= full.height) continue;
    for (int u = 0; u < out.box.width; ++u) {
      const int from_u = (u + first.x) * reduction + reduction / 2 - full.x;
      if (from_u < 0 || from_u >= full.width) continue;
      out.mask.at<uchar>(v, u) = surface.mask.at<uchar>(from_v, from_u);
      out.measured.at<uchar>(v, u) = surface.measured.at<uchar>(from_v, from_u);
      out.depth.at<float>(v, u) = surface.depth.at<float>(from_v, from_u);
    }
  }
  return out;
}

// Returns 255 at the pixels of a sample whose block has a pixel of `mask`, over `surface`.
cv::Mat blocksWith(const cv::Mat& mask, const Surface& surface, const Surface& sample,
                   int reduction) {
  if (reduction == 1) return mask;
  cv::Mat out = cv::Mat::zeros(sample.box.size(), CV_8UC1);
  for (int v = 0; v < mask.rows; ++v) {
    const auto* from = mask.ptr<uchar>(v);
    auto* to = out.ptr<uchar>((v + surface.box.y) / reduction - sample.box.y);
    for (int u = 0; u < mask.cols; ++u) {
      if (from[u] != 0) to[(u + surface.box.x) / reduction - sample.box.x] = 255;
    }
  }
  return out;
}

// Returns the layers of `now` with the names for which their pixels have most votes.
cv::Mat applyNames(const Layers& now, const cv::Mat& votes) {
  struct Overlap {
    long votes;
    int layer, name;
  };
  std::vector<Overlap> overlaps;
  overlaps.reserve(static_cast<std::size_t>(now.count * kMaxLayers));
  for (int layer = 1; layer <= now.count; ++layer) {
    const cv::Mat own = now.labels == layer;
    const cv::Scalar mean = cv::mean(votes, own);
    const double area = cv::countNonZero(own);
    for (int name = 1; name <= kMaxLayers; ++name)
      overlaps.push_back({std::lround(area * mean[name - 1]), layer, name});
  }
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const Overlap& a, const Overlap& b) { return a.votes > b.votes; });
  cv::Mat names = cv::Mat::zeros(1, 256, CV_8UC1);
  std::array<bool, kMaxLayers + 1> taken{};
  for (const Overlap& overlap : overlaps) {
    auto& name = names.at<uchar>(overlap.layer);
    if (name != 0 || taken[static_cast<std::size_t>(overlap.name)]) continue;
    name = static_cast<uchar>(overlap.name);
    taken[static_cast<std::size_t>(overlap.name)] = true;
  }
  cv::Mat out;
  cv::LUT(now.labels, names, out);
  return out;
}

// Mean measured depth of each name around a pixel.
class DepthsBeside {
 public:
  DepthsBeside(const Surface& surface, const cv::Mat& names) {
    const cv::Size window(kBeside_px, kBeside_px);
    for (int name = 1; name <= kMaxLayers; ++name) {
      const cv::Mat own = (names == name) & surface.measured;
      cv::Mat& weight = weights_[std::size_t(name)];
      own.convertTo(weight, CV_32F, 1.0 / 255.0);
      cv::Mat sum = surface.depth.mul(weight);
      cv::boxFilter(sum, sum, CV_32F, window, {-1, -1}, true, cv::BORDER_CONSTANT);
      cv::boxFilter(weight, weight, CV_32F, window, {-1, -1}, true, cv::BORDER_CONSTANT);
      cv::divide(sum, cv::max(weight, 1e-6), means_[std::size_t(name)]);
    }
  }
  // Returns whether `z` is nearer to the depth of one name than to that of another by `margin_mm`.
  [[nodiscard]] bool isNearer(const cv::Point& at, float z, int to, int than,
                              double margin_mm) const {
    const auto knows = [&](int name) { return weights_[std::size_t(name)].at<float>(at) > kKnown; };
    const auto off = [&](int name) {
      return std::abs(double(z - means_[std::size_t(name)].at<float>(at)));
    };
    return knows(to) && knows(than) && off(to) + margin_mm < off(than);
  }

 private:
  static constexpr float kKnown = 0.04F;  // of the window: three pixels
  std::array<cv::Mat, kMaxLayers + 1> weights_;
  std::array<cv::Mat, kMaxLayers + 1> means_;
};

// Names over a whole surface, from those of its sample.
class FullSizeNames {
 public:
  FullSizeNames(const Surface& sample, const cv::Mat& names, int reduction, double margin_mm)
      : sample_(sample),
        names_(names),
        reduction_(reduction),
        margin_mm_(margin_mm),
        depths_(sample, names) {
    cv::dilate(names, largest_, cv::Mat::ones(3, 3, CV_8UC1));
    cv::Mat filled = names.clone();
    filled.setTo(255, names == 0);
    cv::erode(filled, smallest_, cv::Mat::ones(3, 3, CV_8UC1));
  }
  [[nodiscard]] cv::Mat applyTo(const Surface& surface) const {
    cv::Mat out = cv::Mat::zeros(surface.box.size(), CV_8UC1);
    for (int v = 0; v < out.rows; ++v) {
      for (int u = 0; u < out.cols; ++u) {
        if (surface.mask.at<uchar>(v, u) == 0) continue;
        const cv::Point at((u + surface.box.x) / reduction_ - sample_.box.x,
                           (v + surface.box.y) / reduction_ - sample_.box.y);
        const bool measured = surface.measured.at<uchar>(v, u) != 0;
        out.at<uchar>(v, u) =
            findName(at, measured ? std::optional(surface.depth.at<float>(v, u)) : std::nullopt);
      }
    }
    return growLabels(surface, kMaxLayers, out);
  }

 private:
  // Returns the name of a pixel in the block `at`. At an edge it may have the other name, if its
  // depth is clearly that of the other.
  [[nodiscard]] uchar findName(const cv::Point& at, const std::optional<float>& depth_mm) const {
    const uchar name = names_.at<uchar>(at);
    if (name == 0 || !depth_mm) return name;
    for (const uchar other : {smallest_.at<uchar>(at), largest_.at<uchar>(at)}) {
      if (other != name && depths_.isNearer(at, *depth_mm, other, name, margin_mm_)) return other;
    }
    return name;
  }

  const Surface& sample_;
  const cv::Mat& names_;
  int reduction_;
  double margin_mm_;
  DepthsBeside depths_;
  cv::Mat smallest_;  // name in the 3 x 3 blocks around
  cv::Mat largest_;
};

// Assigns small components of a name to their neighbours.
cv::Mat removeSmallComponents(const Surface& surface, const cv::Mat& names) {
  const int area = cv::countNonZero(surface.mask);
  const int smallest_px = std::max(kCrumb_px, static_cast<int>(kCrumbShare * area));
  cv::Mat seeds = cv::Mat::zeros(names.size(), CV_8UC1);
  for (int name = 1; name <= kMaxLayers; ++name) {
    cv::Mat pieces;
    if (largePieces(names == name, smallest_px, pieces) > 0) seeds.setTo(name, pieces > 0);
  }
  return cv::countNonZero(seeds) > 0 ? growLabels(surface, kMaxLayers, seeds) : names.clone();
}

// Returns the box around the pixels of each name, from 1 to the largest; empty for an unused name.
std::vector<cv::Rect> findBoxes(const cv::Mat& names) {
  std::vector<cv::Rect> out(kMaxLayers + 1);
  for (int v = 0; v < names.rows; ++v) {
    const auto* row = names.ptr<uchar>(v);
    for (int u = 0; u < names.cols; ++u) out[row[u]] |= cv::Rect(u, v, 1, 1);
  }
  out.erase(out.begin());  // pixels without a name
  while (!out.empty() && out.back().empty()) out.pop_back();
  return out;
}

int countUsed(const std::vector<cv::Rect>& boxes) {
  return static_cast<int>(
      std::count_if(boxes.begin(), boxes.end(), [](const cv::Rect& box) { return !box.empty(); }));
}

Surface cutPart(const Surface& surface, const cv::Mat& names, const cv::Rect& box, double name) {
  if (box.empty()) return {};
  const cv::Mat mask = names(box) == name;
  return {box + surface.box.tl(),     mask,
          surface.depth(box).clone(), surface.measured(box) & mask,
          surface.quantum_mm,         surface.reduction};
}

// Returns whether no name but the first has votes, up to their rounding.
bool hasOnlyFirst(const cv::Mat& votes) {
  cv::Mat others;
  cv::bitwise_and(votes, cv::Scalar(0, 0xF8, 0xF8, 0xF8), others);
  return cv::countNonZero(others.reshape(1)) == 0;
}

// Returns `image` over `from`, moved to `to`; 0 where it is new.
cv::Mat moveImage(const cv::Mat& image, const cv::Rect& from, const cv::Rect& to) {
  cv::Mat out = cv::Mat::zeros(to.size(), image.type());
  const cv::Rect common = from & to;
  if (!common.empty()) image(common - from.tl()).copyTo(out(common - to.tl()));
  return out;
}

}  // namespace

// Moves names and votes of the last frame with the object, to its box in this frame.
void LayerCutter::moveTo(const Surface& surface, int reduction) {
  const cv::Point2d centroid_px =
      computeCentroid(cv::moments(surface.mask, true), surface.box.tl());
  if (count_ > 0) {
    if (reduction != reduction_) {
      const double scale = double(reduction_) / reduction;
      const auto scaled = [scale](int x) { return cvRound(x * scale); };
      const cv::Size size(std::max(1, scaled(box_.width)), std::max(1, scaled(box_.height)));
      cv::resize(names_, names_, size, 0, 0, cv::INTER_NEAREST);
      if (!votes_.empty()) cv::resize(votes_, votes_, size, 0, 0, cv::INTER_NEAREST);
      box_ = cv::Rect({scaled(box_.x), scaled(box_.y)}, size);
      centroid_px_ *= scale;
    }
    const cv::Point2d moved = centroid_px - centroid_px_;
    const cv::Rect from = box_ + cv::Point(cvRound(moved.x), cvRound(moved.y));
    names_ = moveImage(names_, from, surface.box);
    names_.setTo(0, surface.mask == 0);
    if (!votes_.empty()) votes_ = moveImage(votes_, from, surface.box);
  }
  reduction_ = reduction;
  box_ = surface.box;
  centroid_px_ = centroid_px;
}

// Adds the names of this frame to the votes. Returns the names that the pixels have now; 0 beside
// known pixels that are new.
cv::Mat LayerCutter::countVotes(const Surface& surface, const cv::Mat& now, double step_mm) {
  const DepthsBeside depths(surface, names_);
  std::array<cv::Mat, kMaxLayers + 1> near;
  for (int name = 1; name <= kMaxLayers; ++name)
    near[std::size_t(name)] = dilateBy(names_ == name, kFollows_px);
  const cv::Mat beside = dilateBy(names_ > 0, kFollows_px);
  cv::Mat out = names_.clone();
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      if (surface.mask.at<uchar>(v, u) == 0) continue;
      const uchar is = now.at<uchar>(v, u);
      uchar& name = out.at<uchar>(v, u);
      auto& votes = votes_.at<Votes>(v, u);
      const auto decide = [&] {
        name = is;
        votes = {};
        votes[is - 1] = 255;
      };
      if (name == 0) {
        if (beside.at<uchar>(v, u) == 0) decide();
        continue;
      }
      for (int i = 0; i < kMaxLayers; ++i)
        votes[i] = uchar(votes[i] + ((i + 1 == is ? 255 : 0) - votes[i]) / kVoteFrames);
      if (is == name) continue;
      const bool follows =
          near[is].at<uchar>(v, u) != 0 && surface.measured.at<uchar>(v, u) != 0 &&
          depths.isNearer({u, v}, surface.depth.at<float>(v, u), is, name, kClearly * step_mm);
      if (follows || votes[is - 1] > votes[name - 1] + kLead) decide();
    }
  }
  return removeSmallComponents(surface, out);
}

cv::Mat LayerCutter::assignNames(const Surface& surface, Layers now, double step_mm) {
  if (now.count < 2) now.labels = surface.mask / 255;
  if (now.count < 2 && votes_.empty()) return now.labels;
  const bool begins = count_ == 0 || cv::countNonZero(names_) == 0;
  if (begins) names_ = now.labels;
  if (begins || votes_.empty()) {
    votes_ = cv::Mat::zeros(names_.size(), CV_8UC4);
    for (int name = 1; name <= kMaxLayers; ++name) {
      cv::Scalar all;
      all[name - 1] = 255;
      votes_.setTo(all, names_ == name);
    }
  }
  if (begins) return names_;
  cv::Mat out = countVotes(surface, applyNames(now, votes_), step_mm);
  if (hasOnlyFirst(votes_)) votes_.release();
  return out;
}

std::vector<Surface> LayerCutter::cut(const Surface& surface, double step_mm,
                                      const DepthRange& mapped_range) {
  const int reduction = surface.reduction;
  const Surface sample = reduction > 1 ? sampleSurface(surface, reduction) : surface;
  moveTo(sample, reduction);
  const double cut_mm = step_mm * (count_ > 1 ? kKeptStep : 1.0);
  const cv::Mat step = blocksWith(findSteps(surface, cut_mm), surface, sample, reduction);
  names_ = assignNames(sample, findLayers(sample, step, cut_mm, mapped_range, reduction), step_mm);
  count_ = countUsed(findBoxes(names_));
  if (count_ < 2 && cv::countNonZero(names_ == 1) > 0) return {surface};
  const cv::Mat names =
      reduction > 1 ? FullSizeNames(sample, names_, reduction, kClearly * step_mm).applyTo(surface)
                    : names_;
  const std::vector<cv::Rect> boxes = findBoxes(names);
  std::vector<Surface> out;
  out.reserve(boxes.size());
  for (const cv::Rect& box : boxes)
    out.push_back(cutPart(surface, names, box, double(out.size() + 1)));
  return out;
}

}  // namespace hapticast::server
