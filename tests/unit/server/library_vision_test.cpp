// SPDX-License-Identifier: MIT
// Source and Vision of the library against the server's own pipeline.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

#include "common/library/frame_export.hpp"
#include "server/include/hapticast/vision.hpp"
#include "server/library/vision/images.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/support/expect_frame.hpp"

namespace hapticast {
namespace {

constexpr std::uint64_t kFrames = 40;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Frame> runServer(const std::string& spec) {
  const auto source = server::openSource(spec, 0.0);
  server::Vision vision(source->info(), {});
  EXPECT_TRUE(vision.scan(*source, nullptr));
  FrameExporter exporter;
  std::vector<Frame> frames;
  while (frames.size() < kFrames) {
    const auto frame = source->read();
    if (!frame) break;
    if (const auto result = vision.push(*frame, mediaTime(frame->clip_time_s)))
      frames.push_back(exporter.convert(result->frame));
  }
  for (const server::VisionResult& each : vision.flush())
    frames.push_back(exporter.convert(each.frame));
  return frames;
}

std::vector<Frame> runLibrary(Source& source, Vision& vision) {
  std::vector<Frame> frames;
  while (frames.size() < kFrames) {
    const auto images = source.read();
    if (!images) break;
    if (auto frame = vision.push(*images)) frames.push_back(std::move(*frame));
  }
  for (Frame& each : vision.flush()) frames.push_back(std::move(each));
  return frames;
}

void expectSame(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.epoch, b.epoch);
  EXPECT_EQ(a.time_s, b.time_s);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    ASSERT_TRUE(a.objects[i].heights && b.objects[i].heights);
    expectSame(a.objects[i], b.objects[i]);
  }
}

void expectSame(const std::vector<Frame>& a, const std::vector<Frame>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(i);
    expectSame(a[i], b[i]);
  }
}

TEST(LibraryVision, MakesTheFramesOfTheServer) {
  Source source("synthetic:bounce");
  EXPECT_EQ(source.info().name, "synthetic:bounce");
  EXPECT_TRUE(source.info().metric);
  EXPECT_FALSE(source.info().live);
  EXPECT_TRUE(source.info().camera.has_value());
  (void)source.read();  // Vision begins the clip again
  Vision vision(source);
  EXPECT_GT(vision.info().max_acceleration_mm_s2, 0.0);
  std::vector<Frame> frames = runLibrary(source, vision);
  ASSERT_GT(frames.size(), kFrames);
  const double begin_s = frames[0].time_s;
  ASSERT_EQ(frames[0].jpeg.size() > 2, true);
  EXPECT_EQ(frames[0].jpeg[0], 0xFF);
  const std::vector<Frame> expected = runServer("synthetic:bounce");
  EXPECT_EQ(begin_s, 1.0 / source.info().fps) << "after the images that were read";
  for (Frame& each : frames) {
    each.time_s -= begin_s;
    for (Object& object : each.objects) {
      for (auto& impact : object.impacts) impact.time_s -= begin_s;
    }
  }
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(frames[i].time_s, expected[i].time_s, 2e-9);
    ASSERT_EQ(frames[i].objects.size(), expected[i].objects.size());
  }
}

TEST(LibraryVision, AFreshSourceGivesTheSameBits) {
  Source source("synthetic:bounce");
  VisionSettings settings;
  settings.pictures = false;
  Vision vision(source, settings);
  const std::vector<Frame> frames = runLibrary(source, vision);
  EXPECT_TRUE(frames[0].jpeg.empty());
  expectSame(frames, runServer("synthetic:bounce"));
}

TEST(LibraryVision, TimesContinueAndTheEpochChangesAfterARewind) {
  Source source("synthetic:bounce");
  (void)source.read();
  const auto before = source.read();
  source.rewind();
  const auto after = source.read();
  EXPECT_NE(after->epoch, before->epoch);
  EXPECT_NEAR(after->time_s, before->time_s + 1.0 / source.info().fps, 1e-12);
  EXPECT_EQ(after->index, 0U);
}

TEST(LibraryVision, WrongSourcesAreRuntimeErrors) {
  for (const char* spec : {"", "synthetic:nothing", "/no/such/file.mp4", "ftp://host/a"})
    EXPECT_THROW(Source source(spec), std::runtime_error) << spec;
  EXPECT_THROW(Source("synthetic:bounce", 500.0), std::runtime_error);
}

/// A moving ball of any size, as images of a user.
class OwnImages {
 public:
  OwnImages(int width_px, int height_px)
      : scene_{.width = width_px,
               .height = height_px,
               .radius_px = 0.3 * std::min(width_px, height_px)} {}

  [[nodiscard]] SourceInfo info() const { return exportSourceInfo(scene_.info()); }
  [[nodiscard]] Images make(std::uint64_t i) const {
    const double u = 0.5 * scene_.width + 0.5 * static_cast<double>(i);
    return exportImages(scene_.frame(i, u, 0.5 * scene_.height), 0.04 * static_cast<double>(i));
  }

 private:
  server::test::BallScene scene_;
};

using Change = std::function<void(Images&)>;

std::vector<Change> wrongImages() {
  return {
      [](Images& images) { images.time_s = -1.0; },
      [](Images& images) { images.time_s -= 0.04; },
      [](Images& images) { images.time_s = std::nan(""); },
      [](Images& images) { images.time_s = 1e10; },
      [](Images& images) { ++images.width_px; },
      [](Images& images) { std::swap(images.width_px, ++images.height_px); },
      [](Images& images) { images.height_px = -1; },
      [](Images& images) { images.rgb.pop_back(); },
      [](Images& images) { images.rgb.clear(); },
      [](Images& images) { images.depth.push_back(1.0F); },
      [](Images& images) { images.depth.clear(); },
      [](Images& images) { images.depth[7] = kNan; },
      [](Images& images) { images.depth[7] = -INFINITY; },
      [](Images& images) { images.mask.resize(3); },
      [](Images& images) { images.mask.clear(); },
  };
}

TEST(LibraryVision, WrongImagesThrowAndChangeNothing) {
  std::mt19937 random(1);
  for (int round = 0; round < 5; ++round) {
    const OwnImages own(std::uniform_int_distribution(40, 120)(random),
                        std::uniform_int_distribution(40, 120)(random));
    Vision plain(own.info());
    Vision disturbed(own.info());
    std::vector<Frame> expected;
    std::vector<Frame> frames;
    for (std::uint64_t i = 0; i < 8; ++i) {
      const Images images = own.make(i);
      if (auto frame = plain.push(images)) expected.push_back(std::move(*frame));
      if (auto frame = disturbed.push(images)) frames.push_back(std::move(*frame));
      for (const Change& change : wrongImages()) {
        Images wrong = own.make(i + 1);
        change(wrong);
        EXPECT_THROW((void)disturbed.push(wrong), std::invalid_argument);
      }
    }
    for (Frame& each : plain.flush()) expected.push_back(std::move(each));
    for (Frame& each : disturbed.flush()) frames.push_back(std::move(each));
    ASSERT_EQ(frames.size(), 8U);
    EXPECT_FALSE(frames[0].objects.empty());
    expectSame(frames, expected);
  }
}

TEST(LibraryVision, ImagesWithoutPictureGiveFramesWithoutPicture) {
  const OwnImages own(80, 60);
  Vision vision(own.info());
  for (std::uint64_t i = 0; i < 4; ++i) {
    Images images = own.make(i);
    images.rgb.clear();
    (void)vision.push(images);
  }
  for (const Frame& each : vision.flush()) {
    EXPECT_TRUE(each.jpeg.empty());
    EXPECT_FALSE(each.objects.empty());
  }
}

TEST(LibraryVision, LevelsAreFrom0To255) {
  const OwnImages own(80, 60);
  SourceInfo info = own.info();
  info.metric = false;
  Vision vision(info);
  Images images = own.make(0);
  EXPECT_THROW((void)vision.push(images), std::invalid_argument) << "depths in mm";
  for (float& each : images.depth) each = 100.0F;
  EXPECT_NO_THROW((void)vision.push(images));
}

TEST(LibraryVision, NoMotionIsMeasuredWhereItIsOff) {
  const OwnImages own(80, 60);
  VisionSettings settings;
  settings.motion = false;
  Vision vision(own.info(), settings);
  for (std::uint64_t i = 0; i < 6; ++i) (void)vision.push(own.make(i));
  for (const Frame& each : vision.flush())
    EXPECT_TRUE(each.objects.at(0).velocity_mm_s.isZero(0.0));
}

TEST(LibraryVision, ColoursKeepTheirOrder) {
  server::RgbdFrame frame;
  frame.color = cv::Mat(1, 2, CV_8UC3, cv::Scalar(1, 2, 3));  // B, G, R
  frame.depth = cv::Mat(1, 2, CV_32FC1, cv::Scalar(5.0));
  frame.depth.at<float>(0, 1) = kNan;
  const Images images = exportImages(frame, 0.5);
  EXPECT_EQ(images.rgb, (std::vector<std::uint8_t>{3, 2, 1, 3, 2, 1}));
  EXPECT_EQ(images.depth, (std::vector<float>{5.0F, 0.0F}));
  const server::RgbdFrame back = importImages(images);
  EXPECT_EQ(back.color.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
  EXPECT_NE(static_cast<const void*>(back.depth.data), images.depth.data());
}

/// The message of the exception that `settings` cause.
std::string complain(const SourceInfo& info, const VisionSettings& settings) {
  try {
    const Vision vision(info, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(LibraryVision, WrongSettingsAreNamed) {
  const SourceInfo info = OwnImages(80, 60).info();
  const auto changed = [](const std::function<void(VisionSettings&)>& change) {
    VisionSettings settings;
    change(settings);
    return settings;
  };
  const std::vector<std::pair<VisionSettings, std::string>> wrong{
      {changed([](auto& s) {
         s.objects = {{80.0, 10.0}};
       }),
       "objects: (80"},
      {changed([](auto& s) {
         s.objects = {{-1.0, 10.0}};
       }),
       "objects: (-1"},
      {changed([](auto& s) {
         s.not_objects = {{10.0, std::nan("")}};
       }),
       "not_objects: (10"},
      {changed([](auto& s) {
         s.objects = s.not_objects = {{10.0, 10.0}};
       }),
       "objects: (10"},
      {changed([](auto& s) {
         s.map_range = {{900.0, 500.0}};
       }),
       "map_range"},
      {changed([](auto& s) { s.fov_deg = 5.0; }), "fov_deg"},
      {changed([](auto& s) { s.fov_deg = std::nan(""); }), "fov_deg"},
      {changed([](auto& s) { s.material.mass_kg = -1.0; }), "mass_kg"},
      {changed([](auto& s) { s.material.dynamic_friction = 2.0; }), "dynamic_friction"},
  };
  for (const auto& [settings, begin] : wrong)
    EXPECT_EQ(complain(info, settings).find(begin), 0U)
        << begin << ": " << complain(info, settings);
  SourceInfo small = info;
  small.width_px = 15;
  EXPECT_EQ(complain(small, {}).find("size"), 0U);
  SourceInfo slow = info;
  slow.fps = 0.0;
  EXPECT_EQ(complain(slow, {}).find("fps"), 0U);
  SourceInfo blind = info;
  blind.camera = SourceInfo::Camera{};
  EXPECT_EQ(complain(blind, {}).find("camera"), 0U);
}

TEST(LibraryVision, APointBesideTheObjectIsNamedAndTheNextImagesBeginAnew) {
  const OwnImages own(80, 60);
  VisionSettings settings;
  settings.objects = {{2.0, 2.0}};
  Vision vision(own.info(), settings);
  Images empty = own.make(0);
  try {
    (void)vision.push(empty);
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find("objects 2,2"), 0U) << error.what();
  }
  EXPECT_THROW((void)vision.push(own.make(1)), std::runtime_error) << "the point stays";
  settings.objects = {{40.0, 30.0}};
  Vision right(own.info(), settings);
  (void)right.push(own.make(0));
  const auto frames = right.flush();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].objects.size(), 1U);
}

TEST(LibraryVision, MaterialAndMassReachTheFrames) {
  const OwnImages own(80, 60);
  VisionSettings settings;
  settings.material.stiffness_N_mm = 0.7;
  settings.material.mass_kg = 0.2;
  Vision vision(own.info(), settings);
  (void)vision.push(own.make(0));
  EXPECT_EQ(vision.info().mass_kg, 0.2);
  EXPECT_EQ(vision.flush().at(0).objects.at(0).material.stiffness_N_mm, 0.7);
}

}  // namespace
}  // namespace hapticast
