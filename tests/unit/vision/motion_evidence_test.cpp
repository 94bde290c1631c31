// SPDX-License-Identifier: MIT
// Two rigid motions: a textured square before a textured ground, each with its own motion.
#include "server/vision/segment/appearance/motion_evidence.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace hapticast::server {
namespace {

const cv::Size kTwoMotions_px(320, 240);
const cv::Rect kMovingSquare(120, 80, 70, 70);

cv::Mat makeTexture(std::mt19937& random) {
  cv::Mat out(kTwoMotions_px, CV_8UC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u)
      out.at<unsigned char>(v, u) = static_cast<unsigned char>(random() % 256);
  }
  cv::GaussianBlur(out, out, {}, 2.0);
  cv::normalize(out, out, 20, 230, cv::NORM_MINMAX);
  return out;
}

struct TwoMotions {
  cv::Mat last, now, mask;
  ObjectFlow flow;

  TwoMotions(const cv::Point& object_px, const cv::Point& ground_px) {
    std::mt19937 random(3);
    const cv::Mat ground = makeTexture(random);
    const cv::Mat object = makeTexture(random);
    last = ground.clone();
    object(kMovingSquare).copyTo(last(kMovingSquare));
    const cv::Matx23d shift(1, 0, ground_px.x, 0, 1, ground_px.y);
    cv::warpAffine(ground, now, shift, kTwoMotions_px, cv::INTER_LINEAR, cv::BORDER_REFLECT);
    object(kMovingSquare).copyTo(now(kMovingSquare + object_px));
    mask = cv::Mat::zeros(kTwoMotions_px, CV_8UC1);
    mask(kMovingSquare).setTo(255);
    flow.similarity = {1, 0, double(object_px.x), 0, 1, double(object_px.y)};
    flow.reliable = true;
  }
  // Returns the evidence with the object's patch of this picture.
  cv::Mat evidence(const OtherMotion& other, ObjectRoi& patch) const {
    const FrameImages images{cv::Mat(kTwoMotions_px, CV_8UC3, cv::Scalar(9, 9, 9)),
                             now,
                             cv::Mat(kTwoMotions_px, CV_32FC1, cv::Scalar(700)),
                             {},
                             {}};
    patch = makePatch(images, mask, flow.similarity, {});
    return computeMotionEvidence(patch, other, flow.similarity);
  }
};

TEST(MotionEvidence, PixelsBelongToTheMotionThatExplainsThem) {
  const TwoMotions two({5, -3}, {-2, 1});
  const auto other = findOtherMotion(two.last, two.now, two.mask, two.flow);
  ASSERT_TRUE(other);
  EXPECT_NEAR(other->similarity(0, 2), -2.0, 0.3);
  EXPECT_NEAR(other->similarity(1, 2), 1.0, 0.3);
  ObjectRoi patch;
  const cv::Mat evidence = two.evidence(*other, patch);
  const cv::Rect square = kMovingSquare + cv::Point(5, -3) - patch.box.tl();
  const cv::Rect inner(square.x + 8, square.y + 8, 54, 54);
  EXPECT_GT(cv::mean(evidence(inner))[0], 0.5);
  const cv::Rect beside(square.br().x + 8, square.y, 8, 70);
  EXPECT_LT(cv::mean(evidence(beside))[0], -0.5);
}

TEST(MotionEvidence, AGroundThatMovesWithTheObjectGivesNoEvidence) {
  const TwoMotions one({4, 2}, {4, 2});
  EXPECT_FALSE(findOtherMotion(one.last, one.now, one.mask, one.flow));
}

TEST(MotionEvidence, WithoutAMotionOfTheObjectThereIsNone) {
  TwoMotions two({5, -3}, {-2, 1});
  two.flow.reliable = false;
  EXPECT_FALSE(findOtherMotion(two.last, two.now, two.mask, two.flow));
}

TEST(MotionEvidence, WhereBothMotionsAreTheSameThereIsNoEvidence) {
  const TwoMotions two({5, -3}, {-2, 1});
  ObjectRoi patch;
  const cv::Mat evidence = two.evidence({two.last, two.flow.similarity}, patch);
  EXPECT_EQ(cv::countNonZero(evidence), 0);
}

}  // namespace
}  // namespace hapticast::server
