// SPDX-License-Identifier: MIT
// The window itself on SDL's display for machines without one: its pictures and its events.
#include "client/view/window/window.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/flat_relief.hpp"

namespace hapticast::client {
namespace {

/// SDL's drivers without display and graphics card; a picture grey as this is shown.
class WindowTest : public ::testing::Test {
 protected:
  WindowTest() {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    setenv("SDL_RENDER_DRIVER", "software", 1);
    ui_state.stream.connected = true;
  }
  static VideoFrame grey(int level) {
    VideoFrame frame{0, 0, mediaTime(1.0), {}};
    cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(level)), frame.jpeg);
    return frame;
  }
  static TickReport touch() {
    TickReport report;
    report.play_time = mediaTime(1.0);
    report.hip_mm = {5.0, -8.0, 12.0};
    report.contact_mm = {6.0, -8.0, 16.0};
    report.static_force_N = {0.9, 0.4, 0.0};
    report.dynamic_force_N = {-0.6, 0.5, 0.0};
    report.force_N = report.static_force_N + report.dynamic_force_N;
    report.lookup = Lookup::kInterpolated;
    report.contact = true;
    report.penetration_mm = 2.0;
    return report;
  }
  static bool is(const cv::Vec3b& pixel, const cv::Scalar& color) {
    return std::abs(pixel[2] - color[2]) < 8 && std::abs(pixel[1] - color[1]) < 8 &&
           std::abs(pixel[0] - color[0]) < 8;
  }
  /// From the tip to the farthest pixel of this colour over the picture.
  static Vec2 drawnWay(const cv::Mat& pixels, const ScenePlace& place, const Vec2& tip,
                       const cv::Scalar& color) {
    Vec2 farthest = Vec2::Zero();
    for (int v = static_cast<int>(place.corner().y()); v < static_cast<int>(place.end().y()); ++v) {
      for (int u = static_cast<int>(place.corner().x()); u < static_cast<int>(place.end().x());
           ++u) {
        const Vec2 way = Vec2(u + 0.5, v + 0.5) - tip;
        if (is(pixels.at<cv::Vec3b>(v, u), color) && way.norm() > farthest.norm()) farthest = way;
      }
    }
    return farthest;
  }
  UiState ui_state;
};

TEST_F(WindowTest, ArrowsPointWhereTheForceDoesInEverySize) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(1280, 720), cv::Size(1920, 1080)}) {
    ViewerWindow window(size.width, size.height);
    window.onPicture(grey(90), Workspace{});
    const TickReport report = touch();
    window.onReport(report);
    window.draw(ui_state);
    const cv::Mat pixels = window.pixels();
    ASSERT_EQ(pixels.size(), size);
    const ScenePlace& place = window.place();
    const double width_px = place.end().x() - place.corner().x();
    // The picture is 160 mm wide, its middle is nominal (0, 0), y goes up.
    const Vec2 tip(place.corner().x() + width_px * (0.5 + 5.0 / 160.0),
                   0.5 * (place.corner().y() + place.end().y()) + width_px * 8.0 / 160.0);
    for (const auto& [color, force_N] : {std::pair(kStaticForceColor, report.static_force_N),
                                         std::pair(kDynamicForceColor, report.dynamic_force_N)}) {
      const Vec2 wanted = 0.09 * width_px * Vec2(force_N.x(), -force_N.y());
      EXPECT_LT((drawnWay(pixels, place, tip, color) - wanted).norm(), 2.5) << size;
    }
    const auto corner = pixels.at<cv::Vec3b>(static_cast<int>(place.end().y()) - 3,
                                             static_cast<int>(place.corner().x()) + 3);
    EXPECT_NEAR(corner[1], 90, 3) << "the picture";
  }
}

TEST_F(WindowTest, ThePictureOfAPausedFrameStaysHoweverLongThePauseIs) {
  ViewerWindow window(640, 480);
  const auto shown = [&] {
    window.draw(ui_state);
    return window.pixels().at<cv::Vec3b>(static_cast<int>(window.place().end().y()) - 3,
                                         static_cast<int>(window.place().corner().x()) + 3)[1];
  };
  window.onPicture(grey(90), Workspace{});
  window.onReport(touch());
  EXPECT_NEAR(shown(), 90, 3);
  for (int i = 1; i <= 200; ++i) {  // far more than are kept
    VideoFrame later = grey(200);
    later.media_time = mediaTime(1.0 + 0.04 * i);
    window.onPicture(std::move(later), Workspace{});
  }
  EXPECT_NEAR(shown(), 90, 3);
  TickReport goes_on = touch();
  goes_on.play_time = mediaTime(9.0);
  window.onReport(goes_on);
  EXPECT_NEAR(shown(), 200, 3);
}

TEST_F(WindowTest, ReceivesKeysPointerAndWheel) {
  ViewerWindow window(640, 480);
  window.onPicture(grey(90), Workspace{});
  TickReport report = touch();
  window.onReport(report);
  EXPECT_TRUE(window.update(ui_state));
  const auto key = [&](SDL_Keycode code) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = code;
    SDL_PushEvent(&event);
    EXPECT_TRUE(window.update(ui_state));
  };
  key(SDLK_SPACE);
  EXPECT_TRUE(ui_state.user.paused);
  key(SDLK_s);
  key(SDLK_d);
  EXPECT_FALSE(ui_state.user.static_on || ui_state.user.dynamic_on);
  key(SDLK_m);
  EXPECT_EQ(ui_state.user.method, Method::kThesis);
  key(SDLK_r);
  EXPECT_EQ(ui_state.user.rearm, 1U);

  SDL_Event motion{};
  motion.type = SDL_MOUSEMOTION;
  const Vec2 at = window.place().fromNominal({-10.0, 20.0});
  motion.motion.x = static_cast<int>(at.x());
  motion.motion.y = static_cast<int>(at.y());
  SDL_PushEvent(&motion);
  EXPECT_TRUE(window.update(ui_state));
  ASSERT_TRUE(ui_state.pointer.known);
  EXPECT_LT((ui_state.pointer.position_mm - Vec3(-10.0, 20.0, 35.0)).norm(), 1.0)
      << "the start is above the picture";
  SDL_Event wheel{};
  wheel.type = SDL_MOUSEWHEEL;
  wheel.wheel.preciseY = -4.0F;
  SDL_PushEvent(&wheel);
  EXPECT_TRUE(window.update(ui_state));
  EXPECT_DOUBLE_EQ(ui_state.pointer.position_mm.z(), 31.0);
  wheel.wheel.preciseY = -0.25F;  // a touchpad
  for (int i = 0; i < 8; ++i) {
    SDL_PushEvent(&wheel);
    EXPECT_TRUE(window.update(ui_state));
  }
  EXPECT_DOUBLE_EQ(ui_state.pointer.position_mm.z(), 29.0);
  wheel.wheel.direction = SDL_MOUSEWHEEL_FLIPPED;
  SDL_PushEvent(&wheel);
  EXPECT_TRUE(window.update(ui_state));
  EXPECT_DOUBLE_EQ(ui_state.pointer.position_mm.z(), 29.25);
  key(SDLK_HOME);
  EXPECT_DOUBLE_EQ(ui_state.pointer.position_mm.z(), 35.0);

  SDL_Event quit{};
  quit.type = SDL_QUIT;
  SDL_PushEvent(&quit);
  EXPECT_FALSE(window.update(ui_state));
}

TEST_F(WindowTest, APointerInTheWindowAtItsStartDoesNotSetTheDepth) {
  ViewerWindow window(640, 480);
  SDL_Event motion{};
  motion.type = SDL_MOUSEMOTION;
  motion.motion.x = 300;
  motion.motion.y = 200;
  SDL_PushEvent(&motion);
  EXPECT_TRUE(window.update(ui_state));
  EXPECT_FALSE(ui_state.pointer.known) << "there is no report yet";
  window.onPicture(grey(90), Workspace{});
  window.onReport(touch());
  window.draw(ui_state);
  EXPECT_TRUE(window.update(ui_state));
  ASSERT_TRUE(ui_state.pointer.known);
  EXPECT_EQ(ui_state.pointer.position_mm.z(), 35.0);
  EXPECT_LT(
      (window.place().fromNominal(ui_state.pointer.position_mm.head<2>()) - Vec2(300, 200)).norm(),
      1.0);
}

TEST_F(WindowTest, OutlinesAndShadesTheTouchedRelief) {
  ViewerWindow window(640, 480);
  const Workspace workspace;
  window.onPicture(grey(60), workspace);
  TickReport report = touch();
  report.contact = false;
  report.hip_mm = {-70.0, 50.0, 20.0};
  report.force_N = report.static_force_N = report.dynamic_force_N = Vec3::Zero();
  window.onReport(report);
  const auto field = std::make_shared<const HeightField>(
      HeightField::prepare(*flatRelief({400, 100, 120, 80}), workspace));
  window.onFrame({report.play_time, {field}});
  const auto at = [&](double u, double v) {
    const Vec2 point = window.place().fromImage({u, v});
    return window.pixels().at<cv::Vec3b>(static_cast<int>(point.y()), static_cast<int>(point.x()));
  };
  const auto press = [&](SDL_Keycode code) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = code;
    SDL_PushEvent(&event);
    EXPECT_TRUE(window.update(ui_state));
    window.draw(ui_state);
  };
  window.draw(ui_state);
  EXPECT_NEAR(at(400, 140)[1], 60, 3) << "not asked for";
  press(SDLK_o);
  for (const Vec2& edge : {Vec2(400, 140), Vec2(519, 140), Vec2(460, 100), Vec2(460, 179)})
    EXPECT_GT(at(edge.x(), edge.y())[1], 160) << edge.transpose();
  for (const Vec2& beside : {Vec2(380, 140), Vec2(460, 140), Vec2(460, 80), Vec2(540, 140)})
    EXPECT_NEAR(at(beside.x(), beside.y())[1], 60, 3) << beside.transpose();
  press(SDLK_v);
  EXPECT_GT(at(460, 140)[2], 120) << "shaded";
  EXPECT_NEAR(at(380, 140)[1], 60, 3);
  press(SDLK_v);
  EXPECT_NEAR(at(460, 140)[1], 60, 3);
  EXPECT_LT(at(20, 460)[1], 40) << "the box of the relief in space";
  press(SDLK_v);
  EXPECT_NEAR(at(20, 460)[1], 60, 3);
  press(SDLK_l);
  EXPECT_TRUE(ui_state.record);
}

TEST_F(WindowTest, ADragInItsBoxTurnsTheReliefAndLeavesTheTipAlone) {
  ViewerWindow window(640, 480);
  window.onPicture(grey(60), Workspace{});
  window.onReport(touch());
  const auto field = std::make_shared<const HeightField>(
      HeightField::prepare(*flatRelief({400, 100, 120, 80}), Workspace{}));
  window.onFrame({touch().play_time, {field}});
  window.draw(ui_state);
  const auto send = [&](SDL_Event event) {
    SDL_PushEvent(&event);
    EXPECT_TRUE(window.update(ui_state));
    window.draw(ui_state);
  };
  SDL_Event key{};
  key.type = SDL_KEYDOWN;
  key.key.keysym.sym = SDLK_v;
  send(key);
  send(key);
  const cv::Rect inside = ReliefBox().rect(window.place());
  const cv::Mat before = window.pixels()(inside).clone();
  SDL_Event button{};
  button.type = SDL_MOUSEBUTTONDOWN;
  button.button.button = SDL_BUTTON_LEFT;
  button.button.x = inside.x + inside.width / 2;
  button.button.y = inside.y + inside.height / 2;
  send(button);
  SDL_Event motion{};
  motion.type = SDL_MOUSEMOTION;
  motion.motion.xrel = 40;
  motion.motion.yrel = -30;
  motion.motion.x = button.button.x;
  motion.motion.y = button.button.y;
  send(motion);
  EXPECT_FALSE(ui_state.pointer.known);
  EXPECT_GT(cv::norm(before, window.pixels()(inside), cv::NORM_L1), 10'000.0);
  button.type = SDL_MOUSEBUTTONUP;
  send(button);
  button.type = SDL_MOUSEBUTTONDOWN;  // the cross in the title
  button.button.x = inside.br().x - 8;
  button.button.y = inside.y + 8;
  send(button);
  EXPECT_NEAR(window.pixels().at<cv::Vec3b>(inside.br().y - 4, inside.x + 40)[1], 60, 3);
}

TEST_F(WindowTest, F2FoldsThePanel) {
  ViewerWindow window(1280, 720);
  window.onPicture(grey(60), Workspace{});
  window.onReport(touch());
  const auto press = [&] {
    SDL_Event key{};
    key.type = SDL_KEYDOWN;
    key.key.keysym.sym = SDLK_F2;
    SDL_PushEvent(&key);
    EXPECT_TRUE(window.update(ui_state));
    window.draw(ui_state);
    return window.place().size().x();
  };
  window.draw(ui_state);
  const double before_px = window.place().size().x();
  EXPECT_GT(press(), before_px);
  EXPECT_EQ(press(), before_px);
}

TEST_F(WindowTest, F1OpensTheHelpAndClosesIt) {
  ViewerWindow window(1280, 720);
  window.onPicture(grey(60), Workspace{});
  window.onReport(touch());
  const auto draw = [&] {
    for (int i = 0; i < 3; ++i) window.draw(ui_state);  // the help finds its size
    return cv::Mat(window.pixels().clone());
  };
  const auto press = [&] {
    SDL_Event key{};
    key.type = SDL_KEYDOWN;
    key.key.keysym.sym = SDLK_F1;
    SDL_PushEvent(&key);
    EXPECT_TRUE(window.update(ui_state));
    return draw();
  };
  const cv::Mat before = draw();
  EXPECT_GT(cv::norm(before, press(), cv::NORM_L1), 1e6);
  EXPECT_LT(cv::norm(before, press(), cv::NORM_L1), 1e5);
}

TEST_F(WindowTest, MeasuresHowFarEyeAndHandAreApart) {
  ViewerWindow window(640, 480);
  window.onPicture(grey(60), Workspace{});  // of 1 s
  for (const double play_s : {1.0, 1.01, 1.01, 1.02}) {
    TickReport report = touch();
    report.play_time = mediaTime(play_s);
    window.onReport(report);
    window.draw(ui_state);
  }
  ASSERT_NE(window.eyeHand(), nullptr);
  EXPECT_EQ(window.eyeHand()->count(), 3U) << "time that stands says nothing";
  EXPECT_EQ(window.eyeHand()->max_ns(), 20'000'000U);
}

TEST_F(WindowTest, WithoutADisplayItReportsSoInOneLine) {
  setenv("SDL_VIDEODRIVER", "x11", 1);
  setenv("DISPLAY", ":987", 1);
  try {
    const ViewerWindow window;
    ADD_FAILURE() << "there is a display :987";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find("no display ("), 0U) << error.what();
  }
  unsetenv("DISPLAY");
}

TEST_F(WindowTest, KeysAndTheTimeBarSeekInARecordingOnDemand) {
  ViewerWindow window;
  const auto press = [&](SDL_Keycode key) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = key;
    SDL_PushEvent(&event);
    EXPECT_TRUE(window.update(ui_state));
  };
  press(SDLK_RIGHT);
  EXPECT_EQ(ui_state.timeline, TimelineRequest{}) << "a stream without a time line";
  window.draw(ui_state);
  const cv::Mat without = window.pixels();
  ui_state.stream.timeline = Timeline{100.0, 40.0, mediaTime(1.0), 1.0};
  window.onReport(touch());
  window.draw(ui_state);
  window.draw(ui_state);  // a new window of Dear ImGui is hidden in its first drawing
  const cv::Mat bar = window.pixels();
  const cv::Rect bottom(0, bar.rows - 20, bar.cols / 2, 20);
  EXPECT_GT(cv::norm(bar(bottom), without(bottom), cv::NORM_L1), 1000.0);
  if (const char* const folder = std::getenv("HAPTICAST_PICTURES"))
    cv::imwrite(std::string(folder) + "/time_bar.png", bar);
  press(SDLK_RIGHT);
  EXPECT_NEAR(ui_state.timeline.seek_s.value_or(0.0), 45.0, 1e-9);
  ui_state.timeline = {};  // sent; the stream has not changed yet
  press(SDLK_LEFT);
  press(SDLK_LEFT);
  EXPECT_NEAR(ui_state.timeline.seek_s.value_or(0.0), 35.0, 1e-9);
  press(SDLK_PAGEUP);
  EXPECT_EQ(ui_state.timeline.speed, 1.5);
  press(SDLK_PAGEDOWN);
  press(SDLK_PAGEDOWN);
  EXPECT_EQ(ui_state.timeline.speed, 0.5);
  ui_state.stream.timeline = Timeline{100.0, 40.0, mediaTime(2.0), 2.0};
  window.draw(ui_state);
  ui_state.stream.timeline->speed = 0.0;  // paused
  window.draw(ui_state);
  press(SDLK_PAGEUP);
  EXPECT_EQ(ui_state.timeline.speed, 4.0);
  for (int i = 0; i < 30; ++i) press(SDLK_LEFT);
  EXPECT_EQ(ui_state.timeline.seek_s, 0.0);
}

}  // namespace
}  // namespace hapticast::client
