// SPDX-License-Identifier: MIT
// The two programs as a user runs them: started, listened to, their log and summary read. Real
// time: everything waits for conditions, with deadlines that a slow machine under a sanitizer
// keeps.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "tests/support/checked_devices.hpp"
#include "tests/support/own_network.hpp"
#include "tests/support/process.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing {

inline constexpr std::chrono::seconds kSoon{60};    // what takes moments on an idle machine
inline constexpr std::chrono::seconds kStart{180};  // a clip is looked through first
inline constexpr const char* kLogColumns =
    "t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,sy_N,sz_N,dx_N,dy_N,dz_N,penetration_mm,lookup,"
    "ahead_x_mm,ahead_y_mm,ahead_z_mm";

inline constexpr double kTouched_N = 0.2;  ///< a larger force is a touch

/// Whether figures of time are worth asserting: a sanitizer is several times slower.
#ifdef HAPTICAST_SANITIZED
inline constexpr bool kFullSpeed = false;
#else
inline constexpr bool kFullSpeed = true;
#endif

/// One row of --log.
struct LogRow {
  double t_s = 0.0;
  Vec3 force_N = Vec3::Zero();
  double penetration_mm = 0.0;
  std::string lookup;
  Vec3 hip_mm = Vec3::Zero();
};

/// Reads the complete rows of a log that may still be growing; a row that is none fails the test.
inline std::vector<LogRow> readLog(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream whole;
  whole << in.rdbuf();
  std::string text = whole.str();
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::istringstream lines(text);
  std::string line;
  std::vector<LogRow> rows;
  if (!std::getline(lines, line)) return rows;
  EXPECT_EQ(line, kLogColumns);
  while (std::getline(lines, line)) {
    std::array<double, 15> values{};
    const char* at = line.data();
    const char* const end = at + line.size();
    bool good = true;
    for (double& value : values) {
      const auto parsed = std::from_chars(at, end, value);
      good = good && parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == ',' &&
             std::isfinite(value);
      if (!good) break;
      at = parsed.ptr + 1;
    }
    EXPECT_TRUE(good) << "row " << rows.size() << ": " << line;
    if (!good) return rows;
    rows.push_back({values[0],
                    {values[5], values[6], values[7]},
                    values[14],
                    {at, std::find(at, end, ',')},
                    {values[2], values[3], values[4]}});
  }
  return rows;
}

class ProgramsTest : public ::testing::Test {
 protected:
  [[nodiscard]] const StateFolder& stateFolder() const { return state_; }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  std::string write(const std::string& name, const std::string& text) const {
    return folder_.write(name, text);
  }

  /// A small clip: a near disc on a far wall, moving a little, with its mask.
  std::string makeClip(const std::string& name, int frames = 6) const {
    for (const char* part : {"rgb", "depth", "mask"})
      std::filesystem::create_directories(path(name) + "/" + part);
    for (int i = 0; i < frames; ++i) {
      cv::Mat color(96, 128, CV_8UC3, cv::Scalar(60, 60, 60));
      cv::Mat depth(96, 128, CV_16UC1, cv::Scalar(2000));
      cv::Mat mask = cv::Mat::zeros(96, 128, CV_8UC1);
      const cv::Point centre(60 + i % 2, 48);
      cv::circle(color, centre, 24, {40, 160, 220}, cv::FILLED);
      cv::circle(depth, centre, 24, cv::Scalar(900), cv::FILLED);
      cv::circle(depth, centre, 12, cv::Scalar(880), cv::FILLED);
      cv::circle(mask, centre, 24, cv::Scalar(1), cv::FILLED);
      const std::string number = "/" + std::to_string(100 + i) + ".png";
      cv::imwrite(path(name) + "/rgb" + number, color);
      cv::imwrite(path(name) + "/depth" + number, depth);
      cv::imwrite(path(name) + "/mask" + number, mask);
    }
    return path(name);
  }

  /// Makes a study whose trials of 2 s have these conditions. Returns its command without a device;
  /// an observer answers, and the results are in the folder out.
  [[nodiscard]] std::vector<std::string> makeStudy(const std::string& conditions) const {
    const auto bake = start(HAPTICAST_SERVER_PROGRAM, {"bake", "synthetic:still", "--frames", "25",
                                                       "-o", path("still.mcap")});
    EXPECT_EQ(bake->wait(kStart), 0) << bake->output();
    const std::string study = write("study.json", R"({"name": "still", "consent": "Touch.",
        "question": {"kind": "likert", "text": "How real?"},
        "defaults": {"recording": "still.mcap", "seconds": 2}, "conditions": )" +
                                                      conditions + "}");
    return {"study",     study,        "--subject",   "1",      "--out",
            path("out"), "--simulate", "threshold=1", "--view", "off"};
  }

  /// Reserves the ports of a server that restarts: no other program can bind them. Where the system
  /// allows no network namespace, another program could bind them.
  static void keepPorts() { (void)enterOwnNetwork(); }

  static std::unique_ptr<Process> start(const char* program, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program);
    return std::make_unique<Process>(std::move(arguments));
  }
  static std::unique_ptr<Process> startServer(std::vector<std::string> arguments,
                                              const std::string& address = "127.0.0.1:0") {
    arguments.insert(arguments.end(), {"--listen", address});
    return start(HAPTICAST_SERVER_PROGRAM, std::move(arguments));
  }
  /// A ball at rest. Without a motion and a scan the server starts in half the time.
  static std::unique_ptr<Process> startStillServer(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.end(), {"--source", "synthetic:still", "--loop", "--map-range",
                                       "520,620", "--motion", "none"});
    return startServer(std::move(arguments));
  }
  static std::unique_ptr<Process> startClient(std::vector<std::string> arguments) {
    return start(HAPTICAST_CLIENT_PROGRAM, std::move(arguments));
  }
  /// ADDR:PORT where a server listens, as it says itself; empty (and a failure) if it does not.
  static std::string addressOf(Process& server) {
    EXPECT_TRUE(server.says("listening on ", kStart)) << server.output();
    const std::string text = server.output();
    const std::size_t at = text.find("listening on ");
    if (at == std::string::npos) return "";
    const std::size_t begin = at + std::string("listening on ").size();
    return text.substr(begin, text.find(';', begin) - begin);
  }
  /// Waits until log.csv has more than so many ticks with a force.
  [[nodiscard]] bool touchesFor(std::ptrdiff_t ticks) const {
    return waitUntil(kSoon, [&] {
      const std::vector<LogRow> rows = readLog(path("log.csv"));
      return std::count_if(rows.begin(), rows.end(), [](const LogRow& row) {
               return row.force_N.norm() > kTouched_N;
             }) > ticks;
    });
  }
  /// Waits until the force of a later time than now in log.csv is there, or is zero.
  [[nodiscard]] bool forceIs(bool force) const {
    const std::size_t before = readLog(path("log.csv")).size();
    return waitUntil(kSoon, [&] {
      const std::vector<LogRow> rows = readLog(path("log.csv"));
      if (rows.size() <= before) return false;
      const double now_N = rows.back().force_N.norm();
      return force ? now_N > kTouched_N : now_N == 0.0;
    });
  }
  /// Ends a program as Ctrl-C does.
  static void interrupt(Process& program, int number = SIGINT) {
    program.signal(number);
    EXPECT_EQ(program.wait(kSoon), 0) << program.output();
  }

 private:
  const TempFolder folder_;
  const StateFolder state_{folder_ / "state"};
};

}  // namespace hapticast::testing
