// SPDX-License-Identifier: MIT
// The local quadratic fit: one fixed kernel where the whole window lies in the mask, a 6 x 6 solve
// at the rim, both from separable Gaussian moments.
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/enhance.hpp"

namespace hapticast::server {

namespace {

constexpr int kOrders = 5;  // moments x^0 .. x^4
// Basis 1, x, y, x², xy, y² as exponents of x and y.
constexpr std::array<std::array<int, 2>, 6> kBasis{
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};
// A little pull to zero of slopes and curvatures, for slivers of mask that do not determine them.
constexpr std::array<double, 6> kRidge{0, 1e-7, 1e-7, 1e-4, 1e-4, 1e-4};

struct Kernels {
  std::array<cv::Mat, kOrders> x;  // g(k) (k / sigma)^j
  int radius_px = 0;
};

Kernels kernelsOf(double sigma_px) {
  Kernels out;
  out.radius_px = static_cast<int>(std::ceil(3 * sigma_px));
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

// The moment from one that was taken along x only.
cv::Mat alongY(const cv::Mat& along_x, const Kernels& kernels, int j) {
  cv::Mat out;
  cv::filter2D(along_x, out, CV_32F, kernels.x[static_cast<std::size_t>(j)], {-1, -1}, 0,
               cv::BORDER_CONSTANT);
  return out;
}
cv::Mat alongX(const cv::Mat& image, const Kernels& kernels, int i) {
  cv::Mat out;
  cv::sepFilter2D(image, out, CV_32F, kernels.x[static_cast<std::size_t>(i)],
                  cv::Mat::ones(1, 1, CV_32F), {-1, -1}, 0, cv::BORDER_CONSTANT);
  return out;
}

// K = g(x) g(y) (a + b (x² + y²)) with sum K = 1 and sum K x² = sum K y² = 0.
cv::Mat interiorFit(const cv::Mat& values, const Kernels& kernels) {
  const double m2 = cv::sum(kernels.x[2])[0];
  const double m4 = cv::sum(kernels.x[4])[0];
  const double a = 1 / (1 - 2 * m2 * m2 / (m4 + m2 * m2));
  const double b = -a * m2 / (m4 + m2 * m2);
  return a * moment(values, kernels, 0, 0) +
         b * (moment(values, kernels, 2, 0) + moment(values, kernels, 0, 2));
}

void fitRim(const cv::Mat& values, const cv::Mat& weight, const cv::Mat& rim,
            const Kernels& kernels, cv::Mat& out) {
  std::array<std::array<cv::Mat, kOrders>, kOrders> of_mask;
  for (int i = 0; i < kOrders; ++i) {
    const cv::Mat along_x = alongX(weight, kernels, i);
    for (int j = 0; i + j < kOrders; ++j) {
      of_mask[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          alongY(along_x, kernels, j);
    }
  }
  const std::array<cv::Mat, 3> along_x{alongX(values, kernels, 0), alongX(values, kernels, 1),
                                       alongX(values, kernels, 2)};
  std::array<cv::Mat, 6> of_values;
  for (std::size_t k = 0; k < 6; ++k)
    of_values[k] = alongY(along_x[static_cast<std::size_t>(kBasis[k][0])], kernels, kBasis[k][1]);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      if (rim.at<unsigned char>(v, u) == 0) continue;
      Eigen::Matrix<double, 6, 6> normal;
      Eigen::Matrix<double, 6, 1> right;
      for (std::size_t r = 0; r < 6; ++r) {
        right[static_cast<Eigen::Index>(r)] = double(of_values[r].at<float>(v, u));
        for (std::size_t c = 0; c < 6; ++c) {
          const auto i = static_cast<std::size_t>(kBasis[r][0] + kBasis[c][0]);
          const auto j = static_cast<std::size_t>(kBasis[r][1] + kBasis[c][1]);
          normal(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
              double(of_mask[i][j].at<float>(v, u));
        }
      }
      for (std::size_t r = 1; r < 6; ++r) {
        normal(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(r)) +=
            kRidge[r] * normal(0, 0);
      }
      const double value = normal.llt().solve(right)[0];
      out.at<float>(v, u) = std::isfinite(value) ? static_cast<float>(value) : 0.0F;
    }
  }
}

}  // namespace

cv::Mat quadraticFit(const cv::Mat& values, const cv::Mat& mask, double sigma_px) {
  const Kernels kernels = kernelsOf(sigma_px);
  cv::Mat weight;
  mask.convertTo(weight, CV_32F, 1.0 / 255.0);
  // About the mean, so that float moments do not lose the small differences that matter.
  const double mean = cv::mean(values, mask)[0];
  const cv::Mat centred = (values - mean).mul(weight);
  cv::Mat out = interiorFit(centred, kernels);
  cv::Mat window_inside;
  const int size = 2 * kernels.radius_px + 1;
  cv::erode(mask, window_inside, cv::Mat::ones(size, size, CV_8UC1), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
  fitRim(centred, weight, mask & (window_inside == 0), kernels, out);
  return out + mean;
}

}  // namespace hapticast::server
