// SPDX-License-Identifier: MIT
// What the chain does to streams that do not lie: the scenes of the server, bodies in fast motion
// and the real clips, through vision and wire, with frames lost on the way, under every scripted
// hand.
#include <filesystem>
#include <memory>
#include <random>

#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/evaluate/touch/touch_scenes.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"
#include "tests/support/clips.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct HonestStream {
  std::string name;
  Stream stream;
};

/// Sends a stream as it was made, as soon as it is complete, but for what is lost on the way.
class HonestServer {
 public:
  HonestServer(const Stream& stream, double lost) : stream_(stream), lost_(lost) {}

  [[nodiscard]] std::vector<std::uint8_t> welcome() const {
    Welcome welcome;
    welcome.description = stream_.description;
    return encode(welcome);
  }
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> messages(double until_s) {
    std::vector<std::vector<std::uint8_t>> out;
    const double latency_s = toSeconds(stream_.description.pipeline_latency);
    while (next_ < stream_.frames.size() &&
           stream_.frames[next_].time_s + latency_s + kWay_s <= until_s) {
      const bool lost = next_ > 0 && std::bernoulli_distribution(lost_)(random_);
      if (!lost) out.push_back(*stream_.frames[next_].message);
      ++next_;
    }
    return out;
  }
  [[nodiscard]] static std::optional<std::vector<std::uint8_t>> answer(const Ping& ping,
                                                                       double now_s) {
    return encode(Pong{ping.t0, mediaTime(now_s), mediaTime(now_s)});
  }

 private:
  static constexpr double kWay_s = 0.01;
  const Stream& stream_;
  double lost_;
  std::mt19937_64 random_{5};
  std::size_t next_ = 0;
};

std::vector<HonestStream> honestStreams(bool quick) {
  std::vector<std::pair<std::string, std::function<Stream()>>> makers;
  const auto source = [&](const std::string& spec, const std::string& name) {
    makers.emplace_back(name, [spec] {
      const auto opened = server::openSource(spec, 0.0);
      return makeStream(*opened, {}, true);
    });
  };
  const auto scene = [&](const std::string& name, const std::function<TouchScene()>& make) {
    StreamKind kind;
    kind.scan = true;
    makers.emplace_back(name, [make, kind] { return makeStream(make(), kind); });
  };
  for (const server::SceneName& each : server::kSceneNames) {
    source("synthetic:" + std::string(each.name), std::string(each.name));
  }
  scene("sphere, 10 px a frame", [] { return movingSphere(10.0); });
  scene("sphere, 40 px a frame", [] { return movingSphere(40.0); });
  scene("plate, 5 mm at 1 Hz", swingingPlate);
  scene("dome that breathes", breathingDome);
  scene("ellipsoid that turns", spinningEllipsoid);
  scene("box that comes and goes", drivenBox);
  scene("ball that bounces", [] { return bouncingBall(1500.0, 0.6, 0.5); });
  if (!quick) {
    for (const char* clip : {"visp_rbt_desk", "dkvfx_typing_person", "tum_fr1_rpy"}) {
      const std::filesystem::path folder = test::clipsFolder() / clip;
      if (std::filesystem::exists(folder)) source(folder.string(), clip);
    }
  }
  std::vector<HonestStream> streams(makers.size());
  onAllCores(makers.size(), [&](std::size_t i) {
    streams[i] = {makers[i].first, makers[i].second()};
  });
  return streams;
}

struct HonestRun {
  const HonestStream* stream;
  HandKind hand;
  double lost;
  client::Felt felt;
  TickReport last;
};

void play(HonestRun& run) {
  const HandScript script(run.hand, {});
  auto viewer = std::make_unique<VirtualViewer>(RoomSettings{}, PlantProfile{}, client::Hand::light(),
                                                &script);
  HonestServer server(run.stream->stream, run.lost);
  run.last = converse(server, *viewer, run.stream->stream.frames.back().time_s + 1.0);
  run.felt = std::move(viewer->felt);
}

}  // namespace

void stabilityHonest(const StabilityReport& to) {
  const std::vector<HonestStream> streams = honestStreams(to.options.quick);
  std::vector<HonestRun> runs;
  for (const HonestStream& stream : streams) {
    for (const HandKind hand : {HandKind::kPress, HandKind::kSlide, HandKind::kFollow}) {
      for (const double lost : {0.0, 0.2}) runs.push_back({&stream, hand, lost, {}, {}});
    }
  }
  onAllCores(runs.size(), [&](std::size_t i) { play(runs[i]); });
  for (const HonestRun& r : runs) {
    std::fprintf(stderr, "%-26s %d %.1f c%5ld F%5.2f w%7.1f | ", r.stream->name.c_str(), (int)r.hand, r.lost,
      (long)std::count(r.felt.contact.begin(), r.felt.contact.end(), true), r.felt.max_force_N, r.felt.work_mJ.back());
    for (std::size_t b = 0; b < kInterferenceNames.size(); ++b) {
      int in = 0, most = 0;
      for (std::size_t i = 0; i < r.felt.interferences.size(); ++i) {
        in += (r.felt.interferences[i] >> b) & 1;
        if (i >= 1000) in -= (r.felt.interferences[i-1000] >> b) & 1;
        most = std::max(most, in);
      }
      std::fprintf(stderr, "%.5s %d ", kInterferenceNames[b], most);
    }
    std::fprintf(stderr, "\n");
  }
}

}  // namespace hapticast::evaluate
