// SPDX-License-Identifier: MIT
#include "common/library/frame_import.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "common/library/frame_export.hpp"
#include "common/wire_limits.hpp"
#include "tests/support/expect_frame.hpp"

namespace hapticast {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

StreamInfo smallInfo() {
  StreamInfo info;
  info.name = "small";
  info.width_px = 90;
  info.height_px = 70;
  return info;
}

class AnyFrame {
 public:
  explicit AnyFrame(unsigned seed) : random_(seed) {}

  Frame make() {
    Frame frame;
    frame.epoch = static_cast<std::uint32_t>(whole(0, 5));
    frame.time_s = number(-10.0, 1e4);
    const int objects = whole(0, static_cast<int>(kMaxObjects));
    for (int i = 0; i < objects; ++i) frame.objects.push_back(makeObject(i));
    return frame;
  }

 private:
  int whole(int least, int most) { return std::uniform_int_distribution(least, most)(random_); }
  double number(double least, double most) {
    return std::uniform_real_distribution(least, most)(random_);
  }
  Vec3 vector(double most) {
    return {number(-most, most), number(-most, most), number(-most, most)};
  }
  std::optional<double> maybe(double least, double most) {
    return whole(0, 1) == 0 ? std::nullopt : std::optional(number(least, most));
  }

  std::shared_ptr<HeightMap> makeHeights() {
    const int width = whole(1, 90);
    const int height = whole(1, 70);
    auto map =
        std::make_shared<HeightMap>(whole(0, 90 - width), whole(0, 70 - height), width, height);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        if (whole(0, 2) > 0) map->set(u, v, static_cast<float>(number(0.0, 30.0)));
      }
    }
    return map;
  }

  std::shared_ptr<Object::CellMotion> makeCells(const HeightMap& map) {
    auto cells = std::make_shared<Object::CellMotion>();
    cells->columns = (map.width_px + 15) / 16;
    cells->rows = (map.height_px + 15) / 16;
    for (int i = 0; i < cells->columns * cells->rows; ++i) {
      cells->velocity_mm_s.emplace_back(vector(1e3).cast<float>());
      cells->acceleration_mm_s2.emplace_back(vector(1e5).cast<float>());
    }
    return cells;
  }

  Object makeObject(int number_of) {
    Object object;
    object.id = static_cast<std::uint32_t>(number_of / 2);
    object.layer = static_cast<std::uint32_t>(number_of % 2);
    const auto map = whole(0, 4) == 0 ? nullptr : makeHeights();
    object.heights = map;
    object.position_mm = vector(1e3);
    object.velocity_mm_s = vector(1e4);
    object.acceleration_mm_s2 = vector(1e6);
    object.angle_rad = number(-10.0, 10.0);
    object.angular_velocity_rad_s = number(-10.0, 10.0);
    object.quality = number(0.0, 1.0);
    object.visible_fraction = number(0.0, 1.0);
    if (map && whole(0, 1) == 0) object.cells = makeCells(*map);
    for (int i = whole(0, 4); i > 0; --i) object.impacts.push_back({number(0.0, 9.0), vector(1e3)});
    object.material = {maybe(0.0, 1e3), maybe(0.0, 1e3), maybe(0.0, 1.5),
                       maybe(0.0, 1.5), maybe(0.0, 1e3), maybe(1e-3, 1e3)};
    return object;
  }

  std::mt19937 random_;
};

TEST(FrameImport, AnyFrameComesBackUnchanged) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    FrameImporter importer(smallInfo());
    FrameExporter exporter;
    const Frame frame = AnyFrame(seed).make();
    const Frame back = exporter.convert(importer.import(frame, seed + 1));
    EXPECT_EQ(back.id, seed + 1);
    EXPECT_EQ(back.epoch, frame.epoch);
    EXPECT_NEAR(back.time_s, frame.time_s, 1e-9);
    ASSERT_EQ(back.objects.size(), frame.objects.size());
    for (std::size_t i = 0; i < frame.objects.size(); ++i)
      expectSame(frame.objects[i], back.objects[i]);
  }
}

TEST(FrameImport, UnchangedHeightsAreSharedAndKeepTheirFrame) {
  FrameImporter importer(smallInfo());
  FrameExporter exporter;
  Frame frame;
  frame.objects.emplace_back().heights = std::make_shared<HeightMap>(0, 0, 4, 4);
  const HapticFrame first = importer.import(frame, 1);
  const HapticFrame second = importer.import(frame, 2);
  EXPECT_EQ(first.objects[0].relief, second.objects[0].relief);
  EXPECT_EQ(second.objects[0].changed_in_frame, 1U);
  const Frame a = exporter.convert(first);
  const Frame b = exporter.convert(second);
  EXPECT_EQ(a.objects[0].heights, b.objects[0].heights);
  frame.objects[0].heights = std::make_shared<HeightMap>(*frame.objects[0].heights);
  EXPECT_EQ(importer.import(frame, 3).objects[0].changed_in_frame, 3U) << "another HeightMap";
}

TEST(FrameImport, RoundedHeightsAreClamped) {
  FrameImporter importer(smallInfo());
  Frame frame;
  auto map = std::make_shared<HeightMap>(0, 0, 2, 2);
  map->set(0, 0, -0.5F);
  map->set(1, 0, 30.5F);
  map->height_mm[3] = std::numeric_limits<float>::quiet_NaN();  // outside the mask
  frame.objects.emplace_back().heights = map;
  const HapticFrame made = importer.import(frame, 1);
  EXPECT_EQ(made.objects[0].relief->height_mm, (std::vector<float>{0.0F, 30.0F, 0.0F, 0.0F}));
}

using Change = std::function<void(Frame&)>;

HeightMap& editHeights(Frame& frame) {
  auto map = std::make_shared<HeightMap>(*frame.objects[0].heights);
  frame.objects[0].heights = map;
  return *map;
}

Object::CellMotion& editCells(Frame& frame) {
  auto cells = std::make_shared<Object::CellMotion>(*frame.objects[0].cells);
  frame.objects[0].cells = cells;
  return *cells;
}

std::vector<Change> wrongFrames() {
  return {
      [](Frame& frame) { frame.time_s = kNan; },
      [](Frame& frame) { frame.time_s = 1e10; },
      [](Frame& frame) { frame.objects[0].position_mm.x() = kNan; },
      [](Frame& frame) { frame.objects[0].position_mm.y() = 2e4; },
      [](Frame& frame) { frame.objects[0].velocity_mm_s.z() = -INFINITY; },
      [](Frame& frame) { frame.objects[0].acceleration_mm_s2.z() = 1e9; },
      [](Frame& frame) { frame.objects[0].angle_rad = kNan; },
      [](Frame& frame) { frame.objects[0].angular_velocity_rad_s = 1e5; },
      [](Frame& frame) { frame.objects[0].quality = 1.1; },
      [](Frame& frame) { frame.objects[0].visible_fraction = kNan; },
      [](Frame& frame) { frame.objects[0].layer = 16; },
      [](Frame& frame) { frame.objects[0].material.mass_kg = 0.0; },
      [](Frame& frame) { frame.objects[0].material.static_friction = kNan; },
      [](Frame& frame) { frame.objects[0].material.stiffness_N_mm = -1.0; },
      [](Frame& frame) { frame.objects[0].impacts.resize(5); },
      [](Frame& frame) {
        frame.objects[0].impacts.push_back({kNan, Vec3::Zero()});
      },
      [](Frame& frame) {
        frame.objects[0].impacts.push_back({1.0, Vec3::Constant(kNan)});
      },
      [](Frame& frame) { frame.objects.push_back(frame.objects[0]); },
      [](Frame& frame) {
        frame.objects.resize(17);
        for (std::uint32_t i = 0; i < 17; ++i) frame.objects[i].id = i + 1;
      },
      [](Frame& frame) { editHeights(frame).height_mm[5] = std::nanf(""); },
      [](Frame& frame) { editHeights(frame).height_mm[5] = 40.0F; },
      [](Frame& frame) { editHeights(frame).height_mm.pop_back(); },
      [](Frame& frame) { editHeights(frame).mask.push_back(0); },
      [](Frame& frame) { editHeights(frame).left_px = -1; },
      [](Frame& frame) { editHeights(frame).left_px = 60; },
      [](Frame& frame) { editHeights(frame).top_px = std::numeric_limits<int>::max(); },
      [](Frame& frame) { editHeights(frame).width_px = -40; },
      [](Frame& frame) { editHeights(frame).height_px = 0; },
      [](Frame& frame) { frame.objects[0].heights = nullptr; },  // the cells stay
      [](Frame& frame) { ++editCells(frame).columns; },
      [](Frame& frame) { editCells(frame).velocity_mm_s.pop_back(); },
      [](Frame& frame) { editCells(frame).velocity_mm_s[0].x() = std::nanf(""); },
      [](Frame& frame) { editCells(frame).acceleration_mm_s2[1].y() = 1e9F; },
  };
}

Frame rightFrame() {
  Frame frame;
  Object& object = frame.objects.emplace_back();
  auto map = std::make_shared<HeightMap>(10, 5, 40, 20);
  for (int v = 0; v < 20; ++v) {
    for (int u = 0; u < 40; ++u) map->set(u, v, 7.0F);
  }
  object.heights = map;
  auto cells = std::make_shared<Object::CellMotion>();
  cells->columns = 3;
  cells->rows = 2;
  cells->velocity_mm_s.assign(6, Eigen::Vector3f::Zero());
  cells->acceleration_mm_s2.assign(6, Eigen::Vector3f::Zero());
  object.cells = cells;
  return frame;
}

TEST(FrameImport, AWrongFrameThrowsOneLineAndChangesNothing) {
  FrameImporter importer(smallInfo());
  const Frame right = rightFrame();
  const auto relief = importer.import(right, 1).objects[0].relief;
  std::uint64_t id = 1;
  for (const Change& change : wrongFrames()) {
    SCOPED_TRACE(id);
    Frame wrong = right;
    change(wrong);
    try {
      (void)importer.import(wrong, ++id);
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      const std::string what = error.what();
      EXPECT_FALSE(what.empty() || what.find('\n') != std::string::npos) << what;
    }
    const HapticFrame after = importer.import(right, ++id);
    EXPECT_EQ(after.objects[0].relief, relief);
    EXPECT_EQ(after.objects[0].changed_in_frame, 1U);
  }
}

TEST(FrameImport, TooManyPixelsInAllThrow) {
  StreamInfo info;
  info.width_px = 1920;
  info.height_px = 1080;
  FrameImporter importer(info);
  Frame frame;
  const auto map = std::make_shared<HeightMap>(0, 0, 1920, 1080);
  for (std::uint32_t id = 1; id <= 2; ++id) {
    Object& object = frame.objects.emplace_back();
    object.id = id;
    object.heights = map;
  }
  EXPECT_NO_THROW((void)importer.import(frame, 1));
  frame.objects.push_back(frame.objects[0]);
  frame.objects.back().id = 3;
  EXPECT_THROW((void)importer.import(frame, 2), std::invalid_argument);
}

TEST(FrameImport, WrongPropertiesOfAStreamThrow) {
  const std::vector<std::function<void(StreamInfo&)>> changes{
      [](StreamInfo& info) { info.name = std::string(257, 'a'); },
      [](StreamInfo& info) { info.name = "\xFF"; },
      [](StreamInfo& info) { info.fps = 0.5; },
      [](StreamInfo& info) { info.fps = kNan; },
      [](StreamInfo& info) { info.width_px = 0; },
      [](StreamInfo& info) { info.height_px = 1081; },
      [](StreamInfo& info) { info.width_mm = 0.0; },
      [](StreamInfo& info) { info.depth_mm = kNan; },
      [](StreamInfo& info) { info.latency_s = -1.0; },
      [](StreamInfo& info) { info.latency_s = 11.0; },
      [](StreamInfo& info) { info.max_acceleration_mm_s2 = -1.0; },
      [](StreamInfo& info) { info.mass_kg = 0.0; },
  };
  for (const auto& change : changes) {
    StreamInfo info = smallInfo();
    change(info);
    EXPECT_THROW((void)importInfo(info), std::invalid_argument);
  }
  const StreamInfo back = exportInfo(importInfo(smallInfo()));
  EXPECT_EQ(back.name, "small");
  EXPECT_EQ(back.width_px, 90);
  EXPECT_EQ(back.fps, 25.0);
}

}  // namespace

TEST(FrameImport, ImpactsKeepTheirDistanceToTheTimeOfTheFrame) {
  Frame frame;
  frame.time_s = 2.0;
  frame.objects.emplace_back().impacts.push_back({1.75, Vec3(0.0, 0.0, 9.0)});
  FrameImporter importer{StreamInfo()};
  const HapticFrame same = importer.import(frame, 1);
  EXPECT_EQ(same.objects[0].impacts[0].time, mediaTime(1.75));
  const HapticFrame moved = importer.import(frame, 2, mediaTime(100.0));
  EXPECT_EQ(moved.media_time, mediaTime(100.0));
  EXPECT_EQ(moved.objects[0].impacts[0].time, mediaTime(99.75));
}

}  // namespace hapticast
