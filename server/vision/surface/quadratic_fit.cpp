// SPDX-License-Identifier: MIT
// Local quadratic regression (Savitzky-Golay in two dimensions): one fixed kernel where the whole
// window lies in the mask, a 6 x 6 solve at the rim. Both use separable Gaussian moments. Thread:
// any.
#include "server/vision/surface/quadratic_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr double kFewestSigma_px = 2.0;  // chosen: fewer pixels would be visible in the result
constexpr double kBeyond = 0.1;          // chosen, of half a step: tolerance of a wider fit
constexpr int kOrders = 5;               // moments x^0 .. x^4
// Basis 1, x, y, x², xy, y² as exponents of x and y.
constexpr std::array<std::array<int, 2>, 6> kBasis{
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
// Chosen: ridge regression of slopes and curvatures, for narrow parts of a mask that do not
// determine them.
constexpr std::array<double, 6> kRidge{0, 1e-7, 1e-7, 1e-4, 1e-4, 1e-4};

struct Kernels {
  std::array<cv::Mat, kOrders> x;  // g(k) (k / sigma)^j
  int radius_px = 0;
};

Kernels makeKernels(double sigma_px) {
  Kernels out;
  out.radius_px = static_cast<int>(std::ceil(2.5 * sigma_px));
  double sum = 0;
  for (int k = -out.radius_px; k <= out.radius_px; ++k)
    sum += std::exp(-0.5 * k * k / (sigma_px * sigma_px));
  for (int j = 0; j < kOrders; ++j) {
    cv::Mat& kernel = out.x[static_cast<std::size_t>(j)];
    kernel.create(2 * out.radius_px + 1, 1, CV_32F);
    for (int k = -out.radius_px; k <= out.radius_px; ++k) {
      const double weight = std::exp(-0.5 * k * k / (sigma_px * sigma_px)) / sum;
      kernel.at<float>(k + out.radius_px) = static_cast<float>(weight * std::pow(k / sigma_px, j));
    }
  }
  return out;
}

cv::Mat moment(const cv::Mat& image, const Kernels& kernels, int i, int j) {
  cv::Mat out;
  cv::sepFilter2D(image, out, CV_32F, kernels.x[static_cast<std::size_t>(i)],
                  kernels.x[static_cast<std::size_t>(j)], {-1, -1}, 0, cv::BORDER_CONSTANT);
  return out;
}

// K = g(x) g(y) (a + b (x² + y²)) with sum K = 1 and sum K x² = sum K y² = 0.
cv::Mat fitInterior(const cv::Mat& values, const Kernels& kernels) {
  const double m2 = cv::sum(kernels.x[2])[0];
  const double m4 = cv::sum(kernels.x[4])[0];
  const double a = 1 / (1 - 2 * m2 * m2 / (m4 + m2 * m2));
  const double b = -a * m2 / (m4 + m2 * m2);
  return a * moment(values, kernels, 0, 0) +
         b * (moment(values, kernels, 2, 0) + moment(values, kernels, 0, 2));
}

// Moments of one row of pixels along x: of the mask (x^0 .. x^4) and of the values (x^0 .. x^2).
// One vector of eight, so that they are added together.
constexpr int kAlongX = 8;
using AlongX = cv::Vec<float, kAlongX>;

// Computes the moments at the pixels of `needed` only.
cv::Mat momentsAlongX(const cv::Mat& values, const cv::Mat& weight, const cv::Mat& needed,
                      const Kernels& kernels) {
  const int radius = kernels.radius_px;
  std::vector<AlongX> taps;
  for (int k = 0; k <= 2 * radius; ++k) {
    AlongX tap;
    for (int i = 0; i < kAlongX; ++i)
      tap[i] = kernels.x[std::size_t(i < kOrders ? i : i - kOrders)].at<float>(k);
    taps.push_back(tap);
  }
  cv::Mat out(values.size(), CV_MAKETYPE(CV_32F, kAlongX));
  for (int v = 0; v < out.rows; ++v) {
    const auto* is_needed = needed.ptr<unsigned char>(v);
    const auto* value = values.ptr<float>(v);
    const auto* inside = weight.ptr<float>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (is_needed[u] == 0) continue;
      AlongX sum{};
      for (int at = std::max(0, u - radius); at <= std::min(out.cols - 1, u + radius); ++at) {
        const AlongX& tap = taps[std::size_t(at - u + radius)];
        for (int i = 0; i < kOrders; ++i) sum[i] += tap[i] * inside[at];
        for (int i = kOrders; i < kAlongX; ++i) sum[i] += tap[i] * value[at];
      }
      out.at<AlongX>(v, u) = sum;
    }
  }
  return out;
}

// All moments at one pixel: moments[j][i] is of x^i y^j of the mask, then of the values.
using Moments = std::array<AlongX, kOrders>;

Moments computeMoments(const cv::Mat& along_x, const Kernels& kernels, int v, int u) {
  Moments out{};
  const int radius = kernels.radius_px;
  for (int k = -std::min(radius, v); k <= std::min(radius, along_x.rows - 1 - v); ++k) {
    const auto& row = along_x.at<AlongX>(v + k, u);
    for (std::size_t j = 0; j < kOrders; ++j) {
      const float weight = kernels.x[j].at<float>(k + radius);
      for (int i = 0; i < kAlongX; ++i) out[j][i] += weight * row[i];
    }
  }
  return out;
}

// Returns the constant of the fitted quadratic by an LDL^T decomposition. In reversed order of the
// basis the constant is the last unknown, so no back substitution is needed.
// Measured: 143 ns for each pixel; Eigen's llt() and ldlt() of the same matrix need 207 and 242 ns.
double fitConstant(const Moments& moments) {
  constexpr std::size_t n = kBasis.size();
  std::array<std::array<double, n>, n> lower;
  std::array<double, n> diagonal;
  std::array<double, n> right;
  const double whole = double(moments[0][0]);
  for (std::size_t r = 0; r < n; ++r) {
    const auto [xr, yr] = kBasis[n - 1 - r];
    right[r] = double(moments[static_cast<std::size_t>(yr)][kOrders + xr]);
    for (std::size_t c = 0; c <= r; ++c) {
      const auto [xc, yc] = kBasis[n - 1 - c];
      double sum = double(moments[static_cast<std::size_t>(yr + yc)][xr + xc]);
      if (c == r) sum += kRidge[n - 1 - r] * whole;
      for (std::size_t k = 0; k < c; ++k) sum -= lower[r][k] * lower[c][k] * diagonal[k];
      if (c == r) {
        diagonal[r] = sum;
      } else {
        lower[r][c] = sum / diagonal[c];
      }
    }
    for (std::size_t k = 0; k < r; ++k) right[r] -= lower[r][k] * right[k];
  }
  return right[n - 1] / diagonal[n - 1];
}

// Returns the fit at the pixels of `rim`; 0 elsewhere.
cv::Mat rimFit(const cv::Mat& values, const cv::Mat& weight, const cv::Mat& rim,
               const Kernels& kernels) {
  cv::Mat out = cv::Mat::zeros(values.size(), CV_32FC1);
  cv::Mat needed;
  cv::dilate(rim, needed, cv::Mat::ones(2 * kernels.radius_px + 1, 1, CV_8UC1));
  const cv::Mat along_x = momentsAlongX(values, weight, needed, kernels);
  for (int v = 0; v < out.rows; ++v) {
    const auto* at_rim = rim.ptr<unsigned char>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (at_rim[u] == 0) continue;
      const double value = fitConstant(computeMoments(along_x, kernels, v, u));
      to[u] = std::isfinite(value) ? static_cast<float>(value) : 0.0F;
    }
  }
  return out;
}

// Returns the fit at the pixels of `wanted` (0/255), also outside the mask. `weight`: known share
// of each pixel, 0..1.
cv::Mat fitAtPixels(const cv::Mat& values, const cv::Mat& weight, const cv::Mat& wanted,
                    double sigma_px) {
  const Kernels kernels = makeKernels(sigma_px);
  cv::Mat out = fitInterior(values, kernels);
  cv::Mat window_inside;
  const int size = 2 * kernels.radius_px + 1;
  cv::erode(weight > 0.999, window_inside, cv::Mat::ones(size, size, CV_8UC1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
  const cv::Mat rim = wanted & (window_inside == 0);
  rimFit(values, weight, rim, kernels).copyTo(out, rim);
  return out;
}

// Returns means of blocks of `factor` x `factor` pixels; pixels beyond the image count as zero.
cv::Mat blockMeans(const cv::Mat& image, int factor) {
  const int right = (factor - image.cols % factor) % factor;
  const int below = (factor - image.rows % factor) % factor;
  cv::Mat out;
  cv::copyMakeBorder(image, out, 0, below, 0, right, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::resize(out, out, {out.cols / factor, out.rows / factor}, 0, 0, cv::INTER_AREA);
  return out;
}

// Returns the maxima of the same blocks. Requires values >= 0.
cv::Mat blockMaxima(const cv::Mat& image, int factor) {
  cv::Mat out = cv::Mat::zeros((image.rows + factor - 1) / factor,
                               (image.cols + factor - 1) / factor, CV_32FC1);
  for (int v = 0; v < image.rows; ++v) {
    const auto* from = image.ptr<float>(v);
    auto* to = out.ptr<float>(v / factor);
    for (int u = 0; u < image.cols; ++u) to[u / factor] = std::max(to[u / factor], from[u]);
  }
  return out;
}

cv::Mat scaleFromBlocks(const cv::Mat& image, int factor, const cv::Size& size) {
  cv::Mat out;
  cv::resize(image, out, image.size() * factor, 0, 0, cv::INTER_CUBIC);
  return out(cv::Rect({0, 0}, size));
}

// A wide window needs only every second or third pixel.
cv::Mat fitInFewerPixels(const cv::Mat& values, const cv::Mat& weight, double sigma_px,
                         int factor) {
  const cv::Mat small_weight = blockMeans(weight, factor);
  // Cubic interpolation reads up to two pixels.
  const cv::Mat wanted = dilateBy(small_weight > 0, 2);
  const cv::Mat out =
      fitAtPixels(blockMeans(values, factor), small_weight, wanted, sigma_px / factor);
  return scaleFromBlocks(out, factor, values.size());
}

// Values relative to their mean, so that float moments preserve small differences; zero outside the
// mask.
struct Centred {
  double mean;
  cv::Mat weight;
  cv::Mat values;

  Centred(const cv::Mat& of, const cv::Mat& mask) : mean(cv::mean(of, mask)[0]) {
    mask.convertTo(weight, CV_32F, 1.0 / 255.0);
    values = (of - mean).mul(weight);
  }
};

}  // namespace

cv::Mat fitQuadratic(const cv::Mat& values, const cv::Mat& mask, double sigma_px) {
  const Centred in(values, mask);
  const int factor = std::min(4, static_cast<int>(sigma_px / kFewestSigma_px));
  return in.mean + (factor > 1 ? fitInFewerPixels(in.values, in.weight, sigma_px, factor)
                               : fitAtPixels(in.values, in.weight, mask, sigma_px));
}

cv::Mat fitWider(const cv::Mat& height, const cv::Mat& rounded, const cv::Mat& mask,
                 const cv::Mat& measured, double half_step, double sigma_px) {
  const Centred in(rounded, mask);
  const int factor = std::max(1, static_cast<int>(sigma_px / kFewestSigma_px));
  // The mean of a block's part inside the mask does not belong to the block's centre.
  const cv::Mat whole = blockMeans(in.weight, factor) > 0.999;
  const Centred blocks(blockMeans(in.values, factor), whole);
  const cv::Mat wide =
      blocks.mean + fitAtPixels(blocks.values, blocks.weight, whole, sigma_px / factor);
  cv::Mat change = wide - blockMeans(height - in.mean, factor);
  change.setTo(0, whole == 0);
  cv::Mat off;
  cv::absdiff(height + scaleFromBlocks(change, factor, height.size()), rounded, off);
  off.setTo(0, measured == 0);
  cv::Mat share = (1 + kBeyond - blockMaxima(off, factor) / half_step) / kBeyond;
  share = cv::max(cv::min(share, 1.0), 0.0);
  // A block is half a sigma: deviations in it and in its four neighbours count.
  cv::erode(share, share, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  cv::GaussianBlur(share, share, {}, 1.0);
  return height + scaleFromBlocks(change.mul(share), factor, height.size());
}

namespace {

constexpr int kSweeps = 60;  // chosen: push-pull leaves roughness only a few pixels wide

cv::Mat pushPull(const cv::Mat& weighted, const cv::Mat& weight) {
  cv::Mat mean;
  cv::divide(weighted, cv::max(weight, 1e-6), mean);
  if (weighted.cols <= 2 && weighted.rows <= 2) {
    const double total = cv::sum(weight)[0];
    mean.setTo(total > 0 ? cv::sum(weighted)[0] / total : 0.0, weight <= 1e-6);
    return mean;
  }
  cv::Mat half_weighted;
  cv::Mat half_weight;
  const cv::Size half((weighted.cols + 1) / 2, (weighted.rows + 1) / 2);
  cv::resize(weighted, half_weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, half_weight, half, 0, 0, cv::INTER_AREA);
  cv::Mat coarse;
  cv::resize(pushPull(half_weighted, half_weight), coarse, weighted.size(), 0, 0, cv::INTER_LINEAR);
  coarse.copyTo(mean, weight <= 1e-6);
  return mean;
}

// The neighbours of a hole inside a mask, as offsets in a continuous image.
struct Hole {
  int at = 0;
  int count = 0;
  std::array<int, 4> beside{};
};

std::vector<Hole> findHoles(const cv::Mat& holes, const cv::Mat& inside) {
  std::vector<Hole> out;
  const int columns = holes.cols;
  for (int v = 0; v < holes.rows; ++v) {
    const auto* row = holes.ptr<uchar>(v);
    const auto* in = inside.ptr<uchar>(v);
    for (int u = 0; u < columns; ++u) {
      if (row[u] == 0) continue;
      Hole hole{v * columns + u};
      const auto add = [&hole](bool is_inside, int offset) {
        if (is_inside) hole.beside[std::size_t(hole.count++)] = hole.at + offset;
      };
      add(u + 1 < columns && in[u + 1] != 0, 1);
      add(u > 0 && in[u - 1] != 0, -1);
      add(v + 1 < holes.rows && inside.at<uchar>(v + 1, u) != 0, columns);
      add(v > 0 && inside.at<uchar>(v - 1, u) != 0, -columns);
      if (hole.count > 0) out.push_back(hole);
    }
  }
  return out;
}

// Relaxes the holes of `values` to the mean of their neighbours inside `inside`. With `red_black`
// no hole waits for the hole before it, which is faster.
cv::Mat sweep(const cv::Mat& values, const cv::Mat& inside, const cv::Mat& holes, int sweeps,
              bool red_black) {
  cv::Mat out = values.clone();
  auto* all = out.ptr<float>();
  std::vector<Hole> order = findHoles(holes, inside);
  if (red_black) {
    std::stable_partition(order.begin(), order.end(), [&](const Hole& hole) {
      return (hole.at / out.cols + hole.at % out.cols) % 2 == 0;
    });
  }
  for (int round = 0; round < sweeps; ++round) {
    for (const Hole& hole : order) {
      float sum = 0;
      for (int i = 0; i < hole.count; ++i) sum += all[hole.beside[std::size_t(i)]];
      all[hole.at] = sum / static_cast<float>(hole.count);
    }
  }
  return out;
}

cv::Mat convertToWeight(const cv::Mat& mask) {
  cv::Mat out;
  mask.convertTo(out, CV_32F, 1.0 / 255.0);
  return out;
}

// Returns `small`, each pixel of which is a block of `reduction` x `reduction`, at full size.
cv::Mat enlargeImage(const cv::Mat& small, int reduction, const cv::Size& size) {
  cv::Mat out;
  cv::resize(small, out, small.size() * reduction, 0, 0, cv::INTER_LINEAR);
  return out(cv::Rect({0, 0}, size));
}

// Returns a filling that is smooth up to the size of a block.
cv::Mat fillByBlocks(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted,
                     int reduction) {
  const cv::Mat weight = convertToWeight(known);
  const cv::Mat blocks = blockMeans(weight, reduction);
  const cv::Mat small = pushPull(blockMeans(values.mul(weight), reduction), blocks);
  const cv::Mat small_known = blocks > 1e-6;
  const cv::Mat small_wanted = blockMeans(convertToWeight(wanted), reduction) > 0;
  const cv::Mat out = sweep(small, small_wanted | small_known, small_wanted & ~small_known,
                            kSweeps / reduction, true);
  return enlargeImage(out, reduction, values.size());
}

}  // namespace

cv::Mat fillAtReducedSize(const cv::Mat& values, const cv::Mat& known, int reduction) {
  cv::Mat weight = convertToWeight(known);
  cv::Mat weighted = values.mul(weight);
  if (reduction > 2)
    return pushPull(blockMeans(weighted, reduction), blockMeans(weight, reduction));
  const cv::Size half((values.cols + 1) / 2, (values.rows + 1) / 2);
  cv::resize(weighted, weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, weight, half, 0, 0, cv::INTER_AREA);
  return pushPull(weighted, weight);
}

cv::Mat fillHoles(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted,
                  int reduction) {
  const cv::Mat holes = wanted & (known == 0);
  if (cv::countNonZero(holes) == 0 || cv::countNonZero(known) == 0) return values.clone();
  cv::Mat out;
  if (reduction > 1) {
    out = fillByBlocks(values, known, wanted, reduction);
  } else {
    cv::resize(fillAtReducedSize(values, known, 2), out, values.size(), 0, 0, cv::INTER_LINEAR);
  }
  values.copyTo(out, known);
  return sweep(out, wanted | known, holes, kSweeps / (reduction * reduction), reduction > 1);
}

}  // namespace hapticast::server
