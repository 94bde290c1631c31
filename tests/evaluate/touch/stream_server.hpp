// SPDX-License-Identifier: MIT
// A server under a virtual clock: it sends a finished stream to a VirtualViewer. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/time.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"

namespace hapticast::evaluate {

/// Sends a stream as it was made, as soon as it is complete, but for what is lost on the way.
class StreamServer {
 public:
  StreamServer(const Stream& stream, double lost) : stream_(stream), lost_(lost) {}

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

}  // namespace hapticast::evaluate
