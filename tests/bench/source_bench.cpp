// SPDX-License-Identifier: MIT
// Cost of the server's reader of videos, one thread: a pair of 1920 x 1080 px, beside ffmpeg's
// own decoding of the same two files; depth that is enlarged to 1920 x 1080 px; and the pipes of
// --depth-from. Run:
// build/release/tests/bench --benchmark_filter='Pair|Depth|depth' (CPU time for each frame).
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "server/source/child/child_source.hpp"
#include "server/source/child/depth_task.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/video/video_clip.hpp"
#include "tests/scenes/drawn_source.hpp"
#include "tests/unit/server/depth_edges.hpp"

namespace hapticast::server {
namespace {

constexpr int kDrawn = 6;
constexpr int kRounds = 4;
const cv::Size kFullHd{1920, 1080};

/// CPU time of this process or of its children that ended, s.
double cpuTime_s(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto toSeconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return toSeconds(usage.ru_utime) + toSeconds(usage.ru_stime);
}

/// A pair of videos in a folder of this process, both FFV1: colour, and depth of 16 bits. The depth
/// is that of a sensor of 640 x 360 px, which its recorder enlarged. `noisy`: each pixel of both
/// has noise of its own, which FFV1 cannot compress.
class PairFiles {
 public:
  explicit PairFiles(bool noisy)
      : folder_(std::filesystem::temp_directory_path() /
                ("hapticast_bench_" + std::to_string(::getpid()) + (noisy ? "_noisy" : ""))) {
    std::filesystem::create_directories(folder_);
    std::ofstream color(folder_ / "color.raw", std::ios::binary);
    std::ofstream depth(folder_ / "depth.raw", std::ios::binary);
    for (int i = 0; i < kDrawn; ++i) {
      EdgeScene scene = drawEdgeScene(EdgeShape::kHand, kFullHd, i, 60.0);
      cv::Mat levels;
      scene.depth.convertTo(levels, CV_16U);
      if (!noisy) {
        cv::GaussianBlur(scene.color, scene.color, {}, 1.5);
        cv::resize(levels, levels, {640, 360}, 0.0, 0.0, cv::INTER_NEAREST);
        cv::resize(levels, levels, kFullHd, 0.0, 0.0, cv::INTER_NEAREST);
      }
      color.write(reinterpret_cast<const char*>(scene.color.data),
                  static_cast<std::streamsize>(scene.color.total() * 3));
      depth.write(reinterpret_cast<const char*>(levels.data),
                  static_cast<std::streamsize>(levels.total() * 2));
    }
    color.close();
    depth.close();
    made_ = encode("color", "bgr24", "yuv420p") && encode("depth", "gray16le", "gray16le");
  }
  ~PairFiles() { std::filesystem::remove_all(folder_); }
  PairFiles(const PairFiles&) = delete;
  PairFiles& operator=(const PairFiles&) = delete;

  [[nodiscard]] bool made() const { return made_; }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / (name + ".mkv")).string();
  }

 private:
  [[nodiscard]] bool encode(const std::string& name, const std::string& from,
                            const std::string& to) const {
    const std::string command = "ffmpeg -loglevel quiet -y -stream_loop " +
                                std::to_string(kRounds - 1) +
                                " -f rawvideo -s 1920x1080 -r 30 -pix_fmt " + from + " -i '" +
                                (folder_ / (name + ".raw")).string() + "' -c:v ffv1 -pix_fmt " +
                                to + " '" + path(name) + "' </dev/null";
    return std::system(command.c_str()) == 0;
  }

  std::filesystem::path folder_;
  bool made_ = false;
};

const PairFiles& pairFiles(bool noisy) {
  static const PairFiles kUsual(false);
  static const PairFiles kNoisy(true);
  return noisy ? kNoisy : kUsual;
}

/// Measures the CPU time of `run`, which processes all frames.
template <class Run>
void measurePair(benchmark::State& state, bool noisy, int who, const Run& run) {
  const PairFiles& files = pairFiles(noisy);
  if (!files.made()) return state.SkipWithError("needs ffmpeg with FFV1");
  cv::setNumThreads(1);
  spdlog::set_level(spdlog::level::warn);
  for (auto _ : state) {
    const double before_s = cpuTime_s(who);
    run(files);
    state.SetIterationTime((cpuTime_s(who) - before_s) / (kDrawn * kRounds));
  }
}

void readPair(benchmark::State& state, bool noisy) {
  measurePair(state, noisy, RUSAGE_SELF, [](const PairFiles& files) {
    VideoClip source(files.path("color"), files.path("depth"), 0.0);
    while (auto frame = source.read()) benchmark::DoNotOptimize(frame->depth.data);
  });
}

void ffmpegDecodesPair(benchmark::State& state, bool noisy) {
  measurePair(state, noisy, RUSAGE_CHILDREN, [](const PairFiles& files) {
    for (const char* name : {"color", "depth"}) {
      const std::string command =
          "ffmpeg -loglevel quiet -threads 1 -i '" + files.path(name) + "' -f null - </dev/null";
      if (std::system(command.c_str()) != 0) std::abort();
    }
  });
}
BENCHMARK_CAPTURE(readPair, usual, false)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ffmpegDecodesPair, usual, false)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readPair, noisy, true)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ffmpegDecodesPair, noisy, true)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Depth of half the size beside a hand of the picture's height.
void enlargeDepth(benchmark::State& state) {
  cv::setNumThreads(1);
  const EdgeScene scene = drawEdgeScene(EdgeShape::kHand, kFullHd, 1, 60.0);
  const cv::Mat depth = sampleDepth(scene.depth, {960, 540}, false);
  for (auto _ : state)
    benchmark::DoNotOptimize(scaleDepth(depth, DepthKind::kMetric, scene.color).data);
}
BENCHMARK(enlargeDepth)->Unit(benchmark::kMillisecond);

void enlargeDepthNearest(benchmark::State& state) {
  cv::setNumThreads(1);
  const EdgeScene scene = drawEdgeScene(EdgeShape::kHand, kFullHd, 1, 60.0);
  const cv::Mat depth = sampleDepth(scene.depth, {960, 540}, false);
  for (auto _ : state) {
    cv::Mat scaled;
    cv::resize(depth, scaled, kFullHd, 0.0, 0.0, cv::INTER_NEAREST_EXACT);
    benchmark::DoNotOptimize(scaled.data);
  }
}
BENCHMARK(enlargeDepthNearest)->Unit(benchmark::kMillisecond);

/// A still picture that never ends.
class StillSource final : public test::DrawnSource {
 public:
  StillSource() {
    info_.name = "still";
    info_.width_px = 640;
    info_.height_px = 480;
    info_.frame_count = 1'000'000;
  }

 private:
  RgbdFrame draw(std::uint64_t /*index*/) override {
    RgbdFrame frame;
    frame.color = color_;
    return frame;
  }
  cv::Mat color_{480, 640, CV_8UC3, cv::Scalar(40, 80, 120)};
};

/// CPU of the server for each picture of 640 x 480 px and its depth, through both pipes. The child
/// answers with zeros and computes nothing.
void depthFromChild(benchmark::State& state) {
  spdlog::set_level(spdlog::level::off);
  const std::string command =
      "/usr/bin/env python3 -c '\nimport sys\nanswer = b\"640 480 metric_mm\\n\" + bytes(1228800)\n"
      "while len(sys.stdin.buffer.read(921615)) == 921615:\n"
      "    sys.stdout.buffer.write(answer)\n    sys.stdout.buffer.flush()\n'";
  ChildSource source(std::make_unique<StillSource>(),
                     std::make_unique<DepthTask>(command, kRelativeRange, nullptr), nullptr);
  const double begin_s = cpuTime_s(RUSAGE_SELF);
  std::int64_t frames = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(source.read());
    ++frames;
  }
  state.counters["cpu_ms"] = 1e3 * (cpuTime_s(RUSAGE_SELF) - begin_s) /
                             static_cast<double>(std::max<std::int64_t>(1, frames));
}
BENCHMARK(depthFromChild)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hapticast::server
