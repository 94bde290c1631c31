// SPDX-License-Identifier: MIT
// A malicious server and scripted hands at its stream, in virtual time.
#pragma once

#include "tests/scenes/false_streams/malicious_server.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::client {

inline HandScript handOf(testing::ScriptedHand hand) {
  const auto still = [](const Vec3& at_mm) {
    return std::vector<HandTarget>{{0.0, {at_mm.x(), at_mm.y(), 25.0}},
                                   {0.5, {at_mm.x(), at_mm.y(), 25.0}},
                                   {1.0, at_mm},
                                   {1000.0, at_mm}};
  };
  switch (hand) {
    case testing::ScriptedHand::kHold:
      return {HandKind::kFile, {}, still({0.0, 0.0, 4.0})};
    case testing::ScriptedHand::kShallow:
      return {HandKind::kFile, {}, still({0.0, 0.0, 7.5})};
    case testing::ScriptedHand::kBeside:
      return {HandKind::kFile, {}, still({20.0, 0.0, 4.0})};
    case testing::ScriptedHand::kStroke: {
      std::vector<HandTarget> way = still({0.0, 0.0, 8.0});
      way.pop_back();
      for (int i = 1; i < 2000; ++i) {
        const double t_s = 0.05 * i;
        way.push_back({1.0 + t_s, {8.0 * std::sin(2.0 * M_PI * t_s), 0.0, 8.0}});
      }
      return {HandKind::kFile, {}, std::move(way)};
    }
    case testing::ScriptedHand::kTap: {
      std::vector<HandTarget> way = still({0.0, 0.0, 4.0});
      way.pop_back();
      for (int i = 1; i < 20000; ++i) {
        const double t_s = 0.005 * i;
        way.push_back({1.0 + t_s, {0.0, 0.0, 4.0 - 4.0 * std::sin(14.0 * M_PI * t_s)}});
      }
      return {HandKind::kFile, {}, std::move(way)};
    }
    case testing::ScriptedHand::kPress:
      break;
  }
  return {HandKind::kPress, {}};
}

/// Result of a false stream at a viewer.
struct FalseStreamRun {
  ForceTrace trace;
  TickReport last;
  ReceiverCounts counts;

  /// Ticks in which the chain had to limit something.
  [[nodiscard]] std::ptrdiff_t limitedTicks() const {
    using enum SafetyAction;
    constexpr std::uint32_t kLimits =
        bit(kImplausible) | bit(kTank) | bit(kSlew) | bit(kPassivity) | bit(kSurfaceSpeed) |
        bit(kDisarmed) | bit(kStiffness) | bit(kDamping) | bit(kResidue) | bit(kThermal);
    return trace.ticksWith(kLimits);
  }
  [[nodiscard]] testing::Verdict verdict() const {
    if (trace.refused + trace.rejected > 0) return testing::Verdict::kRefused;
    if (last.halt == Halt::kTrustLost) return testing::Verdict::kTrustLost;
    return limitedTicks() > kFew ? testing::Verdict::kLimited : testing::Verdict::kHarmless;
  }
  /// Whether this is the verdict, or as good as: what is limited may lose trust in the end, and
  /// about kFew ticks are one as well as the other.
  [[nodiscard]] bool is(testing::Verdict wanted) const {
    using enum testing::Verdict;
    const testing::Verdict got = verdict();
    const bool between = limitedTicks() > kFew / 2 && limitedTicks() < 3 * kFew;
    return got == wanted || (wanted == kLimited && got == kTrustLost) ||
           (between && (wanted == kLimited || wanted == kHarmless) &&
            (got == kLimited || got == kHarmless));
  }

 private:
  static constexpr std::ptrdiff_t kFew = 20;  // a stream that ends makes some
};
/// Runs a false stream for `seconds` at a light hand. `nailed`: the tip cannot move.
inline FalseStreamRun runFalseStream(const testing::FalseStream& false_stream, double seconds,
                                     const Hand& hand = Hand::light(), bool nailed = false,
                                     std::optional<double> datagram_loss = std::nullopt) {
  RendererSettings renderer;
  PlantProfile plant;
  const HandScript script = handOf(false_stream.hand);
  auto viewer = std::make_unique<VirtualViewer>(renderer, plant, hand, nailed ? nullptr : &script);
  if (nailed) viewer->nail({0.1, 0.1, 8.0});
  if (datagram_loss) viewer->byDatagrams(*datagram_loss);
  testing::MaliciousServer server(false_stream);
  FalseStreamRun out;
  out.last = runSession(server, *viewer, seconds);
  out.trace = std::move(viewer->trace);
  out.counts = viewer->counts();
  return out;
}

}  // namespace hapticast::client
