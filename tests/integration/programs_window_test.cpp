// SPDX-License-Identifier: MIT
// The window as a person uses it, on SDL's display for machines without one: a real server streams
// a ball, pointer and keys come as SDL's events, the force acts on the mouse.
#include "client/view/window/window.hpp"

#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>
#include <regex>
#include <utility>

#include "client/commands/touch_command.hpp"
#include "common/cli/run_program.hpp"
#include "tests/integration/programs_fixture.hpp"

namespace hapticast::testing {
namespace {

using client::TickReport;
using client::ViewerWindow;

/// The real window, and somebody who sits before it: `each_turn` looks and acts.
class TestView final : public client::View {
 public:
  using EachTurn = std::function<void(ViewerWindow& window, const TickReport& report)>;
  TestView(EachTurn each_turn, TickReport& last) : each_turn_(std::move(each_turn)), last_(last) {}
  void onPicture(VideoFrame picture, const Workspace& workspace) override {
    window_.onPicture(std::move(picture), workspace);
  }
  void onReport(const TickReport& report) override {
    last_ = report;
    window_.onReport(report);
  }
  bool update(client::UiState& ui_state) override {
    each_turn_(window_, last_);
    return window_.update(ui_state);
  }
  void finish() override { window_.finish(); }
  [[nodiscard]] bool points() const override { return window_.points(); }

 private:
  ViewerWindow window_{960, 540};
  EachTurn each_turn_;
  TickReport& last_;
};

void key(SDL_Keycode code) {
  SDL_Event event{};
  event.type = SDL_KEYDOWN;
  event.key.keysym.sym = code;
  SDL_PushEvent(&event);
}

void pointAt(const ViewerWindow& window, const Vec2& nominal_mm) {
  const Vec2 at = window.place().fromNominal(nominal_mm);
  SDL_Event event{};
  event.type = SDL_MOUSEMOTION;
  event.motion.x = static_cast<int>(at.x());
  event.motion.y = static_cast<int>(at.y());
  SDL_PushEvent(&event);
}

void wheel(float notches) {
  SDL_Event event{};
  event.type = SDL_MOUSEWHEEL;
  event.wheel.preciseY = notches;
  SDL_PushEvent(&event);
}

/// A story in steps: each waits for something, then does something.
class Story {
 public:
  struct Step {
    const char* awaited;
    std::function<bool(const TickReport& report)> comes;
    std::function<void(ViewerWindow& window, const TickReport& report)> then;
  };
  explicit Story(std::vector<Step> steps) : steps_(std::move(steps)) {}

  void goOn(ViewerWindow& window, const TickReport& report) {
    if (at_ == steps_.size()) return;
    if (report.time - since_ > kSoon) {
      ADD_FAILURE() << "never came: " << steps_[at_].awaited << "; contact " << report.contact
                    << ", force " << report.force_N.transpose() << " N, tip "
                    << report.hip_mm.transpose() << " mm, over the object " << report.over_object
                    << ", safety actions " << report.safety_actions;
      at_ = steps_.size();
      end();
      return;
    }
    if (!steps_[at_].comes(report)) return;
    steps_[at_].then(window, report);
    since_ = report.time;
    ++at_;
  }
  [[nodiscard]] bool over() const { return at_ == steps_.size(); }
  static void end() {
    SDL_Event event{};
    event.type = SDL_QUIT;
    SDL_PushEvent(&event);
  }

 private:
  std::vector<Step> steps_;
  std::size_t at_ = 0;
  LocalTime since_{};
};

class ProgramsWindowTest : public ProgramsTest {
 protected:
  ProgramsWindowTest() {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    setenv("SDL_RENDER_DRIVER", "software", 1);
  }
  /// Plays the story with a client of this server. Returns its summary.
  nlohmann::json playStory(Story& story, const std::string& address) {
    client::Settings settings;
    const auto colon = address.rfind(':');
    settings.server = {address.substr(0, colon),
                       static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1)))};
    settings.summary_file = path("summary.json");
    settings.quiet = true;
    client::Views views;
    views.push_back(std::make_unique<TestView>(
        [&story](ViewerWindow& window, const TickReport& report) { story.goOn(window, report); },
        last));
    const SteadyClock clock;
    EXPECT_EQ(client::runTouch(settings, clock, std::move(views)), kDone);
    EXPECT_TRUE(story.over());
    std::ifstream in(settings.summary_file);
    return nlohmann::json::parse(in);
  }
  TickReport last;
};

/// The end of the arrow of the force, of the pixels that were drawn, relative to where the tip is
/// seen.
Vec2 drawnArrow(const cv::Mat& pixels, const client::ScenePlace& place, const Vec3& hip_mm) {
  const Vec2 tip = place.fromNominal(hip_mm.head<2>());
  Vec2 farthest = Vec2::Zero();
  for (int v = static_cast<int>(place.corner().y()); v < static_cast<int>(place.end().y()); ++v) {
    for (int u = static_cast<int>(place.corner().x()); u < static_cast<int>(place.end().x()); ++u) {
      const auto& pixel = pixels.at<cv::Vec3b>(v, u);
      // The static share, in blue, may cover the end of the yellow arrow.
      const auto is = [&](int red, int green, int blue) {
        return std::abs(pixel[2] - red) < 8 && std::abs(pixel[1] - green) < 8 &&
               std::abs(pixel[0] - blue) < 8;
      };
      const bool of_arrow = is(255, 214, 64) || is(64, 120, 255);
      const Vec2 way = Vec2(u + 0.5, v + 0.5) - tip;
      if (of_arrow && way.norm() > farthest.norm()) farthest = way;
    }
  }
  return farthest;
}

TEST_F(ProgramsWindowTest, TheMousePressesIntoTheBallPausesTouchesItAndGoesOn) {
  const auto server = startServer({"--source", "synthetic:bounce", "--loop"});
  const std::string address = addressOf(*server);
  LocalTime since{};
  MediaTime stood{};
  // The wheel leads the tip no nearer than this, and there the pointer takes it at first.
  constexpr double kNearest_mm = 35.0;
  float press = 0.0F;  // notches from there to a press
  const auto wait = [&since](const TickReport& report, double seconds) {
    return report.time - since > fromSeconds(seconds);
  };
  // A client that misses many milliseconds ends the contact. Then the tip has to leave the ball
  // first: the hand lifts it, and presses again.
  bool lifted = false;
  LocalTime apart{};  // of the last report without a force
  const auto presses = [&](const TickReport& report) {
    if (report.contact && report.force_N.norm() > kTouched_N) return true;
    apart = report.time;
    if (!wait(report, 3.0)) return false;
    lifted = !lifted;
    wheel(lifted ? 100.0F : press);
    since = report.time;
    return false;
  };
  Story story(
      {{"a ball", [](const TickReport& r) { return r.object_present && toSeconds(r.time) > 1.0; },
        [](ViewerWindow&, const TickReport&) { key(SDLK_SPACE); }},
       {"standstill",
        [&](const TickReport& r) {
          if (std::exchange(stood, r.play_time) != r.play_time) since = r.time;
          return wait(r, 0.3);
        },
        [](ViewerWindow& window, const TickReport& r) {
          pointAt(window, r.object_centre_mm + Vec2(6.0, 4.0));
        }},
       {"the tip over the ball", [](const TickReport& r) { return r.over_object; },
        [&](ViewerWindow&, const TickReport& r) {
          since = r.time;
          press = static_cast<float>(r.object_centre_height_mm - 9.0 - kNearest_mm);
          wheel(press);
        }},
       {"a press, held",
        [&](const TickReport& r) {
          return presses(r) && r.force_N.norm() > 0.5 && r.time - apart > fromSeconds(0.5);
        },
        [&](ViewerWindow& window, const TickReport& r) {
          EXPECT_EQ(r.play_time, stood) << "paused";
          client::UiState ui_state;
          window.draw(ui_state);
          const cv::Mat pixels = window.pixels();
          const double width_px = window.place().end().x() - window.place().corner().x();
          const Vec3& f = r.force_N;  // z is drawn up and a little to the right
          const Vec2 along(f.x() + 0.35 * f.z(), -f.y() - 0.75 * f.z());
          const Vec2 wanted = 0.09 * width_px * f.norm() * along.normalized();
          EXPECT_LT((drawnArrow(pixels, window.place(), r.hip_mm) - wanted).norm(), 4.0)
              << wanted.transpose();
          EXPECT_GT(wanted.norm(), 20.0);
          since = r.time;
          key(SDLK_s);
        }},
       {"no static force",
        [&](const TickReport& r) { return r.static_force_N == Vec3::Zero() && wait(r, 0.5); },
        [](ViewerWindow&, const TickReport&) {
          key(SDLK_s);
          key(SDLK_m);
          wheel(100.0F);
        }},
       {"a hand that has left", [](const TickReport& r) { return !r.contact; },
        [&](ViewerWindow&, const TickReport& r) {
          since = r.time;
          wheel(press);
        }},
       {"the thesis's method, felt again",
        [&](const TickReport& r) { return presses(r) && r.force_N.norm() > 0.2; },
        [&](ViewerWindow&, const TickReport&) { key(SDLK_SPACE); }},
       {"time that goes on", [&](const TickReport& r) { return r.play_time > stood; },
        [](ViewerWindow&, const TickReport&) {
          key(SDLK_SPACE);
          wheel(-20.0F);
        }},
       {"contact once more", [](const TickReport& r) { return r.contact || !r.over_object; },
        [](ViewerWindow&, const TickReport&) { Story::end(); }}});
  const auto summary = playStory(story, address);
  EXPECT_EQ(summary["step_excess_max_N"], 0.0);
  EXPECT_LE(summary["max_force_N"], 3.3 + 1e-9);
  EXPECT_EQ(last.force_N, Vec3(Vec3::Zero())) << "closed in contact";
  interrupt(*server);
}

/// A display of its own, for a window that others do to as they like; empty name: there is none.
class Display {
 public:
  Display() {
    if (!std::filesystem::exists(kServer)) return;
    server_ = std::make_unique<Process>(std::vector<std::string>{
        kServer, "-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"});
    // The server prints warnings, too.
    static const std::regex kNumber("(^|\n)([0-9]+)\n");
    std::smatch number;
    std::string output;
    const auto ready = [&] {
      output = server_->output();
      return std::regex_search(output, number, kNumber);
    };
    if (waitUntil(kSoon, ready)) name_ = ":" + number[2].str();
  }
  [[nodiscard]] const std::string& name() const { return name_; }
  void end() { server_->signal(SIGKILL); }

 private:
  static constexpr const char* kServer = "/usr/bin/Xvfb";
  std::unique_ptr<Process> server_;
  std::string name_;
};

TEST_F(ProgramsWindowTest, ADisplayThatEndsLetsTheForceDown) {
  Display display;
  if (display.name().empty()) GTEST_SKIP() << "there is no Xvfb to be ended";
  const auto server = startStillServer();
  const std::string log = path("log.csv");
  const auto client = start("/usr/bin/env", {"-u", "SDL_VIDEODRIVER", "DISPLAY=" + display.name(),
                                             HAPTICAST_CLIENT_PROGRAM, addressOf(*server), "--view",
                                             "on", "--device", "virtual", "--log", log});
  const auto contactForceActs = [&] {
    const auto rows = readLog(log);
    return !rows.empty() && rows.back().force_N.norm() > 0.5;
  };
  ASSERT_TRUE(waitUntil(kSoon, contactForceActs)) << client->output();
  display.end();
  EXPECT_EQ(client->wait(kSoon), 1) << client->output();
  EXPECT_EQ(
      countOccurrences("the window closed: the display ended or removed it", client->output()), 1U)
      << client->output();
  const auto rows = readLog(log);
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.back().force_N, Vec3(Vec3::Zero()));
  double largest_step_N = 0.0;
  for (std::size_t i = rows.size() - std::min<std::size_t>(rows.size() - 1, 200); i < rows.size();
       ++i)
    largest_step_N = std::max(largest_step_N, (rows[i].force_N - rows[i - 1].force_N).norm());
  EXPECT_LT(largest_step_N, 0.6) << "ramped";
  interrupt(*server);
}

/// Removes every window of a display (argument 1), from outside.
constexpr const char* kRemoveWindows = R"(
import ctypes, sys
x = ctypes.CDLL("libX11.so.6")
x.XOpenDisplay.restype = ctypes.c_void_p
display = ctypes.c_void_p(x.XOpenDisplay(sys.argv[1].encode()))
x.XDefaultRootWindow.restype = ctypes.c_ulong
x.XDestroySubwindows(display, ctypes.c_ulong(x.XDefaultRootWindow(display)))
x.XSync(display, 0)
)";

TEST_F(ProgramsWindowTest, AWindowThatIsRemovedFromOutsideEndsTheClient) {
  Display display;
  if (display.name().empty()) GTEST_SKIP() << "there is no Xvfb";
  if (!std::filesystem::exists(HAPTICAST_PYTHON)) GTEST_SKIP() << "no Python";
  const auto server = startStillServer();
  const auto client = start("/usr/bin/env", {"-u", "SDL_VIDEODRIVER", "DISPLAY=" + display.name(),
                                             HAPTICAST_CLIENT_PROGRAM, addressOf(*server), "--view",
                                             "on", "--device", "virtual"});
  ASSERT_TRUE(client->says("connected: ", kSoon)) << client->output();
  EXPECT_EQ(Process({HAPTICAST_PYTHON, "-c", kRemoveWindows, display.name()}).wait(kSoon), 0);
  EXPECT_EQ(client->wait(kSoon), 1) << client->output();
  EXPECT_EQ(
      countOccurrences("the window closed: the display ended or removed it", client->output()), 1U)
      << client->output();
  interrupt(*server);
}

TEST_F(ProgramsWindowTest, AWindowThatCannotBeOpenedIsDoneWithout) {
  const auto server = startStillServer();
  const auto client = start("/usr/bin/env", {"-u", "SDL_VIDEODRIVER", "DISPLAY=:987",
                                             HAPTICAST_CLIENT_PROGRAM, addressOf(*server)});
  EXPECT_TRUE(client->says("the client continues without a window: no display (", kSoon))
      << client->output();
  EXPECT_TRUE(client->says("connected: ", kSoon)) << client->output();
  interrupt(*client);
  interrupt(*server);
}

TEST_F(ProgramsWindowTest, LeavesAFilmOfTheTouch) {
  const auto server = startServer({"--source", "synthetic:bounce", "--loop"});
  EXPECT_TRUE(server->says("streaming", kStart)) << server->output();
  const auto client = startClient({addressOf(*server), "--film", path("film.mp4"), "--log",
                                   path("log.csv"), "--summary", path("summary.json")});
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    const auto rows = readLog(path("log.csv"));
    return rows.size() > 1000 && rows.back().t_s > 10.0;  // ten times what is expected
  })) << client->output();
  interrupt(*client);
  std::ifstream in(path("summary.json"));
  const double ticks = nlohmann::json::parse(in)["ticks"];
  const double end_s = readLog(path("log.csv")).back().t_s;
  cv::VideoCapture film(path("film.mp4"));
  EXPECT_EQ(film.get(cv::CAP_PROP_FPS), 25.0);
  double pictures = 0.0;
  for (cv::Mat picture; film.read(picture);) ++pictures;
  EXPECT_GT(pictures, 25.0);
  EXPECT_LE(pictures, (end_s + 1.0) * 25.0);
  EXPECT_GT(ticks, 1000.0);
  interrupt(*server);
}

}  // namespace
}  // namespace hapticast::testing
