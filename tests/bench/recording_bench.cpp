// SPDX-License-Identifier: MIT
// Recordings: what a second of a run costs, how fast a recording plays without pacing, and how long
// a seek in a day takes. The day needs 6 GB of disk and HAPTICAST_LONG_RECORDING=FOLDER.
#include <benchmark/benchmark.h>

#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "client/desk/run_recorder.hpp"
#include "common/playback/recording_player.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"
#include "server/recording/stream_recorder.hpp"
#include "server/source/synthetic/synthetic_source.hpp"
#include "server/vision/vision.hpp"

namespace hapticast {
namespace {

constexpr std::size_t kPictureBytes = 16'000;  // of a real clip of 640 x 480 px

double readProcessTime_s() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Frames of the bouncing ball as they are sent.
std::vector<server::EncodedFrame> makeFrames() {
  server::SyntheticSource source(server::SceneKind::kBounce, 25.0);
  server::Vision vision(source.info(), {});
  server::FrameEncoder encoder;
  std::vector<server::EncodedFrame> frames;
  double time_s = 0.0;
  while (const auto frame = source.read()) {
    const auto result = vision.push(*frame, mediaTime(time_s += 0.04));
    if (result) frames.push_back(encoder.encode(result->frame));
  }
  return frames;
}

server::EncodedVideo makePicture(const server::EncodedFrame& frame) {
  std::vector<std::uint8_t> jpeg(kPictureBytes);
  for (std::size_t i = 0; i < jpeg.size(); ++i) jpeg[i] = static_cast<std::uint8_t>(i * i / 7);
  jpeg[0] = 0xFF;
  jpeg[1] = 0xD8;
  return server::encodeVideo({frame.epoch, frame.id, frame.media_time, std::move(jpeg)});
}

class TempFile {
 public:
  explicit TempFile(const std::filesystem::path& folder)
      : path_(folder / ("hapticast_bench_" + std::to_string(::getpid()) + ".mcap")) {
    remove();
  }
  ~TempFile() { remove(); }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// CPU of the whole process for a second of a run: 1000 ticks, 25 frames, 25 pictures.
void recordSecond(benchmark::State& state) {
  const TempFile file(std::filesystem::temp_directory_path());
  const SteadyClock clock;
  const auto frames = makeFrames();
  const auto picture = decode(*makePicture(frames[0]).payload);
  std::vector<client::AssembledFrame> assembled;
  for (const auto& each : frames) {
    auto message = decode(*each.delta);
    assembled.push_back({{}, std::get<CodedFrame>(std::move(message).value())});
  }
  client::TickReport tick;
  double cpu_s = 0.0;
  {
    client::RunRecorder recorder({file.name(), std::nullopt}, clock);
    const double begin_s = readProcessTime_s();
    for (auto unused : state) {
      (void)unused;
      for (std::size_t i = 0; i < 25; ++i) {
        recorder.onFrame(assembled[i]);
        recorder.onPicture(std::get<VideoFrame>(picture.value()));
        for (int j = 0; j < 40; ++j) {
          ++tick.tick;
          tick.force_N.x() += 1e-3;
          recorder.onTick(tick);
        }
      }
    }
    cpu_s = readProcessTime_s() - begin_s;
  }
  state.counters["cpu_ms"] = 1e3 * cpu_s / static_cast<double>(state.iterations());
}
// More would not fit into the memory for messages that wait.
BENCHMARK(recordSecond)->Iterations(20)->Unit(benchmark::kMillisecond);

/// One frame with its picture, as a server plays it to its viewers, without pacing.
void playFrame(benchmark::State& state) {
  const TempFile file(std::filesystem::temp_directory_path());
  {
    const SteadyClock clock;
    const LocalMediaClock media_clock(clock);
    server::StreamRecorder recorder({file.name(), std::nullopt}, media_clock);
    recorder.describe({});
    for (const auto& each : makeFrames()) {
      recorder.publish(each);
      recorder.publish(makePicture(each));
    }
  }
  RecordingPlayer player(std::move(StreamReader::open(file.name())).value(), true);
  server::FrameSigner signer;
  server::FrameEncoder encoder;
  MediaTime now = player.reader().begin();
  for (auto unused : state) {
    (void)unused;
    for (bool is_frame = false; !is_frame;) {
      now = std::max(now, player.prepare(now).value());
      RecordedItem item = player.take();
      is_frame = std::holds_alternative<CodedFrame>(item);
      if (is_frame) {
        benchmark::DoNotOptimize(
            encoder.encode(std::move(std::get<CodedFrame>(item)), &signer, true));
      } else if (auto* const video = std::get_if<VideoFrame>(&item)) {
        benchmark::DoNotOptimize(server::encodeVideo(std::move(*video)));
      }
    }
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(playFrame)->Unit(benchmark::kMicrosecond);

/// A seek to a random time of 24 h without pictures, with the opening of the file apart.
void seekInADay(benchmark::State& state) {
  const char* const folder = std::getenv("HAPTICAST_LONG_RECORDING");
  if (folder == nullptr || std::filesystem::space(folder).available < 6'000'000'000) {
    state.SkipWithError("left out: it needs HAPTICAST_LONG_RECORDING=FOLDER with 6 GB");
    return;
  }
  const TempFile file(folder);
  const auto frames = makeFrames();
  constexpr double kDay_s = 86'400.0;
  {
    McapWriter writer(file.name(),
                      {makeChannel("/description", "hapticast.proto.StreamDescription"),
                       makeChannel("/frame", "hapticast.proto.HapticFrame")});
    const auto description = encode(StreamDescription{});
    const auto count = static_cast<std::uint64_t>(kDay_s * 25.0);
    for (std::uint64_t i = 0; i < count; ++i) {
      auto message = decode(*frames[i % frames.size()].key_frame->payload());
      auto frame = std::get<CodedFrame>(std::move(message).value());
      frame.id = i + 1;
      frame.media_time = mediaTime(1.0 + 0.04 * static_cast<double>(i));
      for (auto& object : frame.objects) object.changed_in_frame = frame.id;
      const auto time_ns = static_cast<std::uint64_t>(frame.media_time.time_since_epoch().count());
      if (i % 25 == 0) writer.write(0, time_ns, findContent(description));
      const auto encoded = encode(frame);
      writer.write(1, time_ns, findContent(encoded));
      if (i % 25 == 24) writer.flush();
    }
  }
  const double opened_s = readProcessTime_s();
  RecordingPlayer player(std::move(StreamReader::open(file.name())).value(), true);
  state.counters["open_cpu_ms"] = 1e3 * (readProcessTime_s() - opened_s);
  std::uint64_t next = 1;
  for (auto unused : state) {
    (void)unused;
    next = next * 6'364'136'223'846'793'005ULL + 1'442'695'040'888'963'407ULL;
    player.seek(kDay_s * static_cast<double>(next >> 11U) / 9'007'199'254'740'992.0);
    benchmark::DoNotOptimize(player.prepare(mediaTime(1.0)));
  }
}
BENCHMARK(seekInADay)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hapticast
