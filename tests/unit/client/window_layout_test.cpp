// SPDX-License-Identifier: MIT
// Where the window puts its parts; none of it needs a display.
#include <gtest/gtest.h>

#include "client/view/window/layout.hpp"
#include "client/view/window/relief_box.hpp"

namespace hapticast::client {
namespace {

TEST(WindowLayout, InASmallWindowThePictureComesBeforeThePanel) {
  const WindowLayout layout = arrangeWindow({640.0, 480.0}, std::nullopt);
  EXPECT_TRUE(layout.isFolded());
  const ScenePlace place({}, layout.corner, layout.room);
  EXPECT_GT(place.size().x(), 0.9 * 640.0);
  EXPECT_GT(place.size().y(), 0.9 * 480.0);
}

TEST(WindowLayout, AWideWindowShowsThePanelBesideThePicture) {
  for (const Vec2& size : {Vec2(1280.0, 720.0), Vec2(1920.0, 1080.0)}) {
    const WindowLayout layout = arrangeWindow(size, std::nullopt);
    EXPECT_FALSE(layout.isFolded());
    EXPECT_DOUBLE_EQ(layout.corner.x() + layout.room.x() + layout.panel_px, size.x());
    EXPECT_DOUBLE_EQ(layout.corner.y() + layout.room.y(), size.y());
  }
}

TEST(WindowLayout, TheUsersChoiceCountsInEverySize) {
  for (const double width_px : {640.0, 800.0, 1280.0, 1920.0}) {
    EXPECT_TRUE(arrangeWindow({width_px, 720.0}, false).isFolded());
    const WindowLayout open = arrangeWindow({width_px, 720.0}, true);
    EXPECT_FALSE(open.isFolded());
    EXPECT_LE(open.panel_px, width_px / 3.0 + 1e-9);
  }
}

class ReliefBoxTest : public ::testing::Test {
 protected:
  const ScenePlace place{{}, {10.0, 20.0}, {640.0, 480.0}};
  ReliefBox box;
};

TEST_F(ReliefBoxTest, BeginsInTheLowerLeftCorner) {
  const cv::Rect2d rect = box.rect(place);
  EXPECT_DOUBLE_EQ(rect.x, 10.0);
  EXPECT_DOUBLE_EQ(rect.br().y, 500.0);
}

TEST_F(ReliefBoxTest, HasATitleAButtonAndABody) {
  const cv::Rect2d rect = box.rect(place);
  EXPECT_EQ(box.part(place, {rect.x + 5.0, rect.y + 5.0}), BoxPart::kTitle);
  EXPECT_EQ(box.part(place, {rect.br().x - 5.0, rect.y + 5.0}), BoxPart::kClose);
  EXPECT_EQ(box.part(place, {rect.x + 5.0, rect.y + 60.0}), BoxPart::kBody);
  EXPECT_EQ(box.part(place, {rect.x + 5.0, rect.y - 5.0}), BoxPart::kNone);
}

TEST_F(ReliefBoxTest, AMoveKeepsItInsideThePicture) {
  const cv::Rect2d before = box.rect(place);
  box.move(place, {30.0, -40.0});
  EXPECT_NEAR(box.rect(place).x, before.x + 30.0, 1e-9);
  EXPECT_NEAR(box.rect(place).y, before.y - 40.0, 1e-9);
  box.move(place, {1e5, -1e5});
  EXPECT_NEAR(box.rect(place).br().x, 650.0, 1e-9);
  EXPECT_NEAR(box.rect(place).y, 20.0, 1e-9);
}

}  // namespace
}  // namespace hapticast::client
