// SPDX-License-Identifier: MIT
// A client's receiver with its relief cache against any server: what the loop is handed is within
// the announced picture, and the counts stay sane. The input is a script: a byte says what comes, a
// few bytes what is in it; or it is a message as it is, two bytes its length. Frames come whole or
// as the parts of datagrams, which may lie in their headers.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "common/protocol/fragment.hpp"
#include "tests/fuzz/script.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::fuzz::receiver {
namespace {

using namespace hapticast;
using namespace hapticast::client;

struct Client {
  Client() {
    stream.workspace.width_px = 64;
    stream.workspace.height_px = 48;
    receiver.connected(stream, clock.now());
  }

  void take(Message message) {
    if (auto* const frame = std::get_if<CodedFrame>(&message)) {
      receiver.frame(std::move(*frame), clock.now());
    } else if (const auto* const pong = std::get_if<Pong>(&message)) {
      receiver.pong(*pong, clock.now());
    } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
      stream = *description;
      receiver.describe(stream, clock.now());
    }
  }
  /// A frame of up to three objects that share few ids, as the rules of caches are about those.
  CodedFrame makeFrame(Script& script) {
    HapticFrame frame;
    const int jump = script.byte();
    id_ = jump < 250 ? id_ + static_cast<std::uint64_t>(jump % 8) : id_ * 31 - 7;
    frame.id = id_;
    frame.epoch = static_cast<std::uint32_t>(script.byte() / 64);
    frame.media_time = mediaTime(script.byte() - 100);
    for (int i = script.byte() % 4; i > 0; --i) {
      HapticObject object;
      object.id = static_cast<std::uint32_t>(i * 16 + script.byte() % 64);
      object.changed_in_frame =
          frame.id - std::min(frame.id, static_cast<std::uint64_t>(script.byte() % 4));
      const PixelRect rect{script.byte(), script.byte(), 1 + script.byte() % 32,
                           1 + script.byte() % 32};
      if (script.byte() % 2 == 0)
        object.relief = flatRelief(rect, 0.2F * static_cast<float>(script.byte()));
      object.motion.quality = script.byte() / 255.0;
      if (script.byte() % 4 == 0) {
        auto grid = std::make_shared<MotionGrid>();
        grid->columns = gridCells(rect.width);
        grid->rows = gridCells(rect.height);
        const auto cells = static_cast<std::size_t>(grid->columns * grid->rows);
        grid->velocity_mm_s.resize(cells, Eigen::Vector3f::Zero());
        grid->acceleration_mm_s2.resize(cells, Eigen::Vector3f::Zero());
        object.grid = grid;
      }
      frame.objects.push_back(object);
    }
    return testing::coded(frame);
  }
  /// Each part as it is, changed, twice or never; says how many were taken.
  std::uint64_t takeParts(Script& script) {
    const CodedFrame frame = makeFrame(script);
    const auto payloads = packFrame(frame);
    std::uint64_t taken = 0;
    for (std::size_t i = 0; i < payloads.size() && i < 20; ++i) {
      DatagramHeader header{1,
                            frame.epoch,
                            frame.id,
                            frame.media_time,
                            static_cast<std::uint16_t>(i),
                            static_cast<std::uint16_t>(payloads.size())};
      std::span<const std::uint8_t> payload = payloads[i];
      const int change = script.byte();
      if (change % 8 == 1) continue;
      if (change % 8 == 2) header.parts = static_cast<std::uint16_t>(header.parts + change / 8);
      if (change % 8 == 3) header.frame += static_cast<std::uint64_t>(change / 8) * 97;
      if (change % 8 == 4) ++header.epoch;
      if (change % 8 == 5) header.media_time += fromSeconds(change - 120.0);
      if (change % 8 == 6) payload = script.bytes();
      if (change % 8 == 7) payload = payloads[script.byte() % payloads.size()];
      if (receiver.classify(header) != FrameAssembler::Want::kNew) continue;
      (void)receiver.part(header, payload, clock.now());
      ++taken;
    }
    return taken;
  }
  /// What the loop sees.
  void play() {
    FramePool::Index index = 0;
    while (pool->pop(index)) {
      const PlayFrame& frame = pool->frame(index);
      require(frame.object_count <= kMaxObjects);
      for (std::size_t i = 0; i < frame.object_count; ++i) check(frame.objects[i]);
      pool->release(index);
    }
  }
  void check(const PlayObject& object) const {
    require(object.impact_count <= kMaxImpacts);
    if (object.field == nullptr) return;
    const PixelRect& rect = object.field->rect();
    require(rect.u >= 0 && rect.v >= 0 && rect.u + rect.width <= stream.workspace.width_px &&
            rect.v + rect.height <= stream.workspace.height_px);
    if (object.grid == nullptr) return;
    require(object.grid->columns == gridCells(rect.width) &&
            object.grid->rows == gridCells(rect.height));
    require(object.grid->velocity_mm_s.size() ==
            static_cast<std::size_t>(object.grid->columns * object.grid->rows));
  }

  ManualClock clock;
  StreamDescription stream;
  std::unique_ptr<FramePool> pool = std::make_unique<FramePool>();
  LatestValue<StreamTiming> state;
  InlinePreparation preparation{
      *pool, clock, Method::kHapticast,
      [this](const PreparedFrame& frame) { receiver.addPrepared(frame); }};
  Receiver receiver{preparation, state, 1};

 private:
  std::uint64_t id_ = 1;
};

}  // namespace

HAPTICAST_FUZZ_TARGET("receiver") {
  Client client;
  Script script{{data, size}};
  std::uint64_t frames = 0;
  for (int step = 0; !script.rest.empty() && step < 200; ++step) {
    const int kind = script.byte();
    if (kind >= 224) {
      frames += client.takeParts(script);
      if (kind % 4 != 0) (void)client.preparation.step();
      client.play();
      continue;
    }
    switch (kind % 8) {
      case 0: {
        auto message = decode(script.bytes());
        if (message.ok()) client.take(std::move(message).value());
        ++frames;
        break;
      }
      case 1:
        client.clock.advance(std::chrono::milliseconds(script.byte()));
        break;
      case 2:  // an answer to a ping of this moment
        client.receiver.pong({client.clock.now(), mediaTime(script.byte()), mediaTime(100)},
                             client.clock.now());
        break;
      case 3:
        while (client.preparation.step()) {
        }
        client.play();  // what waits in the pool belongs to the picture that is announced
        client.stream.workspace.width_px = 32 + script.byte();
        client.receiver.describe(client.stream, client.clock.now());
        break;
      case 4:
        client.receiver.connected(client.stream, client.clock.now());
        break;
      default:
        client.receiver.frame(client.makeFrame(script), client.clock.now());
        ++frames;
        if (script.byte() % 4 != 0) (void)client.preparation.step();
        client.play();
    }
  }
  while (client.preparation.step()) {
  }
  client.play();
  const ReceiverCounts& counts = client.receiver.counts();
  require(counts.received + counts.duplicates + counts.no_slot <= frames);
  require(counts.lost <= frames * FrameAssembler::kLargestJump);
  return 0;
}

}  // namespace hapticast::fuzz::receiver
