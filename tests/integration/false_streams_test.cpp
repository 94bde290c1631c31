// SPDX-License-Identifier: MIT
// False streams through the two surroundings of ClientSession without sockets: the viewer of a page
// and the player of the library. Those with sockets are in programs_malicious_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "client/include/hapticast/renderer.hpp"
#include "client/include/hapticast/stream.hpp"
#include "client/web/viewer.hpp"
#include "tests/scenes/false_streams/malicious_server.hpp"

namespace hapticast::testing {
namespace {

constexpr int kLast_ms = 8000;
constexpr int kRetry_ms = 200;

/// What surrounds a session.
struct Surroundings {
  std::function<void(int ms)> begin;
  /// Returns false if the session ends.
  std::function<bool(const Bytes& message, int ms)> push;
  std::function<std::vector<Ping>(int ms)> pings;
  std::function<void(int ms)> tick;
};

/// Plays a stream in virtual time, again 0.2 s after each end. Returns how many sessions ended.
int play(const FalseStream& stream, const Surroundings& at) {
  MaliciousServer server(stream);
  int ends = 0, begin_ms = 0, next_ms = 0;
  bool is_open = false;
  for (int ms = 0; ms < kLast_ms; ++ms) {
    const auto send = [&](const Bytes& message) {
      if (!is_open || at.push(message, ms)) return;
      is_open = false;
      next_ms = ms + kRetry_ms;
      ++ends;
    };
    if (!is_open && ms >= next_ms) {
      is_open = true;
      begin_ms = ms;
      at.begin(ms);
      send(server.welcome());
    }
    const double since_s = 1e-3 * (ms - begin_ms);
    for (const Ping& ping : at.pings(ms)) {
      if (const auto answer = server.answer(ping, since_s)) send(*answer);
    }
    if (is_open) {
      for (const Bytes& message : server.messages(since_s)) send(message);
    }
    at.tick(ms);
  }
  return ends;
}

LocalTime toLocal(int ms) { return localTime(1.0 + 1e-3 * ms); }

/// Where the hand wants to be: from above it goes into the plateau, and stays.
Vec3 handAt(int ms) { return {0.0, 0.0, ms < 1000 ? 25.0 : 7.5}; }

struct Outcome {
  int ends = 0;
  std::uint64_t rejected = 0;
  bool trust_lost = false;
  int limited_ticks = 0;
  double most_N = 0.0;
  double last_N = 0.0;

  void add(const Vec3& force_N) {
    EXPECT_TRUE(force_N.allFinite());
    last_N = force_N.norm();
    most_N = std::max(most_N, last_N);
  }
};

Outcome playInPage(const FalseStream& stream) {
  const auto viewer = std::make_unique<client::WebViewer>();
  Outcome out;
  out.ends = play(stream, {.begin = [&](int ms) { ASSERT_TRUE(viewer->open({}, toLocal(ms))); },
                           .push =
                               [&](const Bytes& message, int ms) {
                                 if (viewer->receive(message, toLocal(ms))) return true;
                                 EXPECT_TRUE(viewer->close(toLocal(ms)));
                                 return false;
                               },
                           .pings =
                               [&](int ms) {
                                 std::vector<Ping> pings;
                                 while (const auto bytes = viewer->poll(toLocal(ms))) {
                                   const auto message = decode(*bytes);
                                   if (const auto* ping = std::get_if<Ping>(&message.value()))
                                     pings.push_back(*ping);
                                 }
                                 return pings;
                               },
                           .tick =
                               [&](int ms) {
                                 while (viewer->prepareNext(toLocal(ms))) {
                                 }
                                 viewer->point(handAt(ms));
                                 out.add(viewer->tick(toLocal(ms)).force_N);
                               }});
  const client::ReceiverCounts& counts = viewer->counts();
  out.rejected = counts.reliefs_rejected + counts.slices_refused + counts.malformed;
  out.trust_lost = viewer->report().halt == client::Halt::kTrustLost;
  return out;
}

Outcome playInLibrary(const FalseStream& stream) {
  Renderer renderer;
  MessagePlayer player(renderer);
  Outcome out;
  out.ends = play(
      stream, {.begin = [](int /*ms*/) {},
               .push =
                   [&](const Bytes& message, int ms) {
                     try {
                       player.push(message, toSeconds(toLocal(ms)));
                       return true;
                     } catch (const std::runtime_error&) {
                       return false;
                     }
                   },
               .pings =
                   [](int ms) {
                     return ms % 20 == 0 ? std::vector<Ping>{{toLocal(ms)}} : std::vector<Ping>();
                   },
               .tick =
                   [&](int ms) {
                     const double time_s = toSeconds(toLocal(ms));
                     player.release(time_s);
                     const Tick& tick = renderer.tick(time_s, renderer.toDevice(handAt(ms)));
                     out.add(tick.force_N);
                     out.trust_lost = tick.halted;
                     out.limited_ticks += tick.safety_actions != 0 ? 1 : 0;
                   }});
  return out;
}

/// The first two streams of each verdict that come over TCP with an honest clock.
std::vector<const FalseStream*> selectStreams() {
  std::vector<const FalseStream*> selected;
  for (const Verdict verdict : {Verdict::kRefused, Verdict::kTrustLost, Verdict::kLimited}) {
    int left = 2;
    for (const FalseStream& each : falseStreams()) {
      const bool usual = each.answers && each.clock == nullptr && each.alter_datagrams == nullptr &&
                         each.hand == ScriptedHand::kHold;
      if (each.verdict == verdict && usual && left-- > 0) selected.push_back(&each);
    }
  }
  return selected;
}

TEST(FalseStreams, MeetTheirVerdictsInThePageAndInTheLibrary) {
  const auto streams = selectStreams();
  ASSERT_EQ(streams.size(), 6U);
  for (const FalseStream* const stream : streams) {
    SCOPED_TRACE(stream->name);
    const Outcome page = playInPage(*stream);
    const Outcome library = playInLibrary(*stream);
    for (const Outcome& each : {page, library}) {
      EXPECT_LE(each.most_N, client::DeviceProfile{}.peak_N + 1e-9);
      if (each.trust_lost) {
        EXPECT_EQ(each.last_N, 0.0);
      }
    }
    EXPECT_EQ(page.ends, library.ends);
    EXPECT_GT(std::min(page.most_N, library.most_N), 0.1) << "the plateau is honest at first";
    EXPECT_EQ(page.ends > 0 || page.rejected > 0, stream->verdict == Verdict::kRefused);
    if (stream->verdict == Verdict::kTrustLost) {
      EXPECT_TRUE(page.trust_lost);
      EXPECT_TRUE(library.trust_lost || library.limited_ticks > 100) << "its hand does not yield";
    }
  }
}

}  // namespace
}  // namespace hapticast::testing
