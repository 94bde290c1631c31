// SPDX-License-Identifier: MIT
// Cost of each step on the way of a frame, 640 x 480, one thread. Run: build/release/tests/bench
// (see its --help); quote ratios from one run, medians over --benchmark_repetitions.
#include <benchmark/benchmark.h>

#include "common/protocol/fragment.hpp"
#include "common/protocol/messages.hpp"
#include "server/source/synthetic/synthetic_source.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/encoded.hpp"
#include "server/vision/describe.hpp"
#include "server/vision/vision.hpp"
#include "tests/support/coded.hpp"

namespace hapticast {
namespace {

/// A whole clip of a synthetic scene, rendered before it is timed.
std::vector<server::RgbdFrame> clip(server::SceneKind kind, bool with_mask) {
  server::SyntheticSource source(kind, 25.0);
  std::vector<server::RgbdFrame> frames;
  while (auto frame = source.read()) {
    if (!with_mask) frame->mask.release();
    frames.push_back(std::move(*frame));
  }
  return frames;
}

/// A frame as vision makes it, with its relief.
server::VisionResult visionResult() {
  server::SyntheticSource source(server::SceneKind::kTumble, 25.0);
  server::Vision vision(source.info(), {});
  for (int i = 0;; ++i) {
    auto result = vision.push(*source.read(), mediaTime(0.04 * i));
    if (result && i >= 20) return std::move(*result);
  }
}

void visionPush(benchmark::State& state, server::SceneKind kind, bool with_mask) {
  const auto frames = clip(kind, with_mask);
  server::Vision vision(server::SyntheticSource(kind, 25.0).info(), {});
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        vision.push(frames[i % frames.size()], mediaTime(0.04 * static_cast<double>(i))));
    ++i;
  }
}
BENCHMARK_CAPTURE(visionPush, tumble_source_mask, server::SceneKind::kTumble, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(visionPush, tumble_band, server::SceneKind::kTumble, false)
    ->Unit(benchmark::kMillisecond);

void encodeFrame(benchmark::State& state) {
  const server::VisionResult result = visionResult();
  // A coder that has seen a relief before would not code it again.
  const auto bytes = [&] { return encode(FrameCoder().code(result.frame)); };
  for (auto _ : state) benchmark::DoNotOptimize(bytes());
  state.counters["bytes"] = static_cast<double>(bytes().size());
}
BENCHMARK(encodeFrame)->Unit(benchmark::kMicrosecond);

/// A coded frame as signed datagrams.
void signDatagrams(benchmark::State& state) {
  const CodedFrame frame = FrameCoder().code(visionResult().frame);
  server::FrameSigner signer;
  for (auto _ : state) benchmark::DoNotOptimize(signer.signDatagrams(frame));
  const auto bodies = signer.signDatagrams(frame);
  state.counters["datagrams"] = static_cast<double>(bodies->size());
  std::size_t bytes = 0;
  for (const auto& body : *bodies) bytes += kTokenBytes + body.size();
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(signDatagrams)->Unit(benchmark::kMicrosecond);

void signOneDatagram(benchmark::State& state) {
  SigningKey key;
  const std::vector<std::uint8_t> payload(kMostPieceBytes, 7);
  for (auto _ : state) benchmark::DoNotOptimize(signedBody({}, payload, key));
}
BENCHMARK(signOneDatagram)->Unit(benchmark::kMicrosecond);

void verifyOneDatagram(benchmark::State& state) {
  SigningKey key;
  const auto verifying = VerifyingKey::from(key.verifyingKey());
  std::vector<std::uint8_t> bytes = probeBody(1, key);
  bytes.insert(bytes.begin(), kTokenBytes, 0);
  for (auto _ : state) {
    const auto datagram = readDatagram(bytes);
    benchmark::DoNotOptimize(verifying.value().verify(datagram->signed_bytes, datagram->signature));
  }
}
BENCHMARK(verifyOneDatagram)->Unit(benchmark::kMicrosecond);

/// A sealed datagram, without its signature.
void sealOneDatagram(benchmark::State& state) {
  SealingKey key(1);
  const std::vector<std::uint8_t> payload(kMostPieceBytes, 7);
  for (auto _ : state) {
    std::vector<std::uint8_t> body(kDatagramHeaderBytes - kTokenBytes);
    body.reserve(kMostDatagramBytes);
    key.seal(body, payload);
    benchmark::DoNotOptimize(body.data());
  }
}
BENCHMARK(sealOneDatagram)->Unit(benchmark::kMicrosecond);

void openOneDatagram(benchmark::State& state) {
  SigningKey signer;
  SealingKey seal(1);
  const OpeningKey key(seal.bytes());
  std::vector<std::uint8_t> payload(kMostPieceBytes, 7);
  std::vector<std::uint8_t> bytes =
      signedBody({1, 1, 1, mediaTime(1.0), 0, 1}, payload, signer, &seal);
  bytes.insert(bytes.begin(), kTokenBytes, 0);
  for (auto _ : state) {
    const auto datagram = readDatagram(bytes);
    if (!key.open(datagram->counter, datagram->readable, datagram->sealed, payload))
      state.SkipWithError("the seal does not open");
  }
}
BENCHMARK(openOneDatagram)->Unit(benchmark::kMicrosecond);

void joinDatagrams(benchmark::State& state) {
  const CodedFrame frame = FrameCoder().code(visionResult().frame);
  const auto payloads = packFrame(frame);
  for (auto _ : state) {
    DatagramHeader header{
        0, frame.epoch, frame.id, frame.media_time, 0, static_cast<std::uint16_t>(payloads.size())};
    Reassembly joined(header);
    for (; header.part < payloads.size(); ++header.part)
      benchmark::DoNotOptimize(joined.add(header, payloads[header.part]));
    benchmark::DoNotOptimize(joined.frame());
  }
}
BENCHMARK(joinDatagrams)->Unit(benchmark::kMicrosecond);

void encodeVideo(benchmark::State& state) {
  const server::VisionResult result = visionResult();
  for (auto _ : state) benchmark::DoNotOptimize(server::encodePicture(result.color, 80));
}
BENCHMARK(encodeVideo)->Unit(benchmark::kMicrosecond);

void decodeFrame(benchmark::State& state) {
  const auto bytes = encode(FrameCoder().code(visionResult().frame));
  for (auto _ : state) {
    const auto message = decode(bytes);
    for (const CodedObject& object : std::get<CodedFrame>(message.value()).objects)
      benchmark::DoNotOptimize(testing::decodedRelief(*object.relief));
  }
}
BENCHMARK(decodeFrame)->Unit(benchmark::kMicrosecond);

/// A disc of 200 px in its rectangle, and the relief of a frame of the tumble.
void prepareDisc(benchmark::State& state) {
  Relief relief{{220, 140, 200, 200}, {}, {}};
  for (int v = 0; v < 200; ++v) {
    for (int u = 0; u < 200; ++u) {
      const double r2 = (u - 99.5) * (u - 99.5) + (v - 99.5) * (v - 99.5);
      relief.mask.push_back(r2 < 1e4 ? 1 : 0);
      relief.height_mm.push_back(static_cast<float>(r2 < 1e4 ? 20.0 - 1e-3 * r2 : 0.0));
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(HeightField::prepare(relief, Workspace{}));
}
BENCHMARK(prepareDisc)->Unit(benchmark::kMicrosecond);

void prepareTumble(benchmark::State& state) {
  const server::VisionResult result = visionResult();
  const Relief& relief = *result.frame.objects.at(0).relief;
  for (auto _ : state) benchmark::DoNotOptimize(HeightField::prepare(relief, Workspace{}));
  state.counters["px"] = static_cast<double>(relief.mask.size());
}
BENCHMARK(prepareTumble)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace hapticast
