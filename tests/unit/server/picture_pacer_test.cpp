// SPDX-License-Identifier: MIT
// The pacer at a simulated link: a queue with a rate, a delay each way, and a viewer that confirms
// what arrives. Times are virtual.
#include "server/stream/picture_pacer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "common/wire_limits.hpp"

namespace hapticast::server {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct SimulatedLink {
  double rate_B_s = 0.0;
  Duration delay{0};  // each way
  double loss = 0.0;  // share of packets that come a round trip later, and all behind them
  std::size_t picture_bytes = 20'000;
  std::uint32_t seed = 1;
};

constexpr Duration kPlayed = std::chrono::seconds(30);
constexpr double kFrames_B_s = 25.0 * 1560.0;
constexpr double kPictures_B_s = 25.0 * 20'000.0;

struct Simulated {
  std::vector<double> waits_ms;  // of frames, behind pictures
  double picture_bytes = 0;
};

/// Plays frames and pictures at 25 Hz over `link` for `length`, in steps of 1 ms.
class LinkSimulation {
 public:
  explicit LinkSimulation(const SimulatedLink& link) : link_(link), random_(link.seed) {}

  /// Plays until `end`.
  const Simulated& run(Duration end) {
    for (; now_ < LocalTime(end); now_ += milliseconds(1)) {
      receive();
      if ((now_.time_since_epoch() / milliseconds(1)) % 40 == 0) publish();
      while (picture_left_ > 0 || waits_) {
        if (picture_left_ == 0) {
          picture_left_ = link_.picture_bytes;
          waits_ = false;
        }
        const std::size_t part = std::min(pacer_.computePartBytes(now_), picture_left_);
        if (part == 0) break;
        send(part, true);
        picture_left_ -= part;
        result_.picture_bytes += static_cast<double>(part);
      }
    }
    return result_;
  }
  void setRate_bytes_s(double rate_B_s) { link_.rate_B_s = rate_B_s; }
  [[nodiscard]] const Simulated& result() const { return result_; }

 private:
  struct Arrival {
    LocalTime at;
    std::uint64_t bytes;
    bool is_part = false;
  };

  void publish() {
    std::normal_distribution<double> size(1560.0, 200.0);
    send(static_cast<std::size_t>(std::max(200.0, size(random_))), false);
    waits_ = true;
  }

  void send(std::size_t bytes, bool is_picture) {
    pacer_.onSent(bytes, now_);
    total_ += bytes;
    const Duration takes = fromSeconds(static_cast<double>(bytes) / link_.rate_B_s);
    free_at_ = std::max(free_at_, now_) + takes;
    if (!is_picture) {
      frames_free_at_ = std::max(frames_free_at_, now_) + takes;  // without pictures
      result_.waits_ms.push_back(1e3 * toSeconds(free_at_ - frames_free_at_));
    }
    LocalTime at = free_at_ + link_.delay;
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    for (std::size_t packet = 0; packet < bytes; packet += 1448)
      if (chance(random_) < link_.loss) at += std::max<Duration>(2 * link_.delay, milliseconds(30));
    last_ = std::max(last_, at);
    down_.push_back({last_, total_, is_picture});
  }

  void receive() {
    while (!down_.empty() && down_.front().at <= now_) {
      arrived_ = down_.front();
      has_part_ = has_part_ || arrived_.is_part;
      down_.pop_front();
      has_more_ = true;
    }
    if (has_part_ && has_more_ && now_ - receipt_at_ >= milliseconds(20)) {
      receipt_at_ = now_;
      has_more_ = false;
      up_.push_back({now_ + link_.delay, {arrived_.bytes, now_ - arrived_.at}});
    }
    while (!up_.empty() && up_.front().first <= now_) {
      pacer_.onReceipt(up_.front().second, now_);
      up_.pop_front();
    }
  }

  SimulatedLink link_;
  std::mt19937 random_;
  PicturePacer pacer_;
  Simulated result_;
  LocalTime now_{milliseconds(1)};
  LocalTime free_at_{}, frames_free_at_{}, last_{}, receipt_at_{};
  std::uint64_t total_ = 0;
  std::deque<Arrival> down_;
  std::deque<std::pair<LocalTime, Receipt>> up_;
  Arrival arrived_{};
  bool has_more_ = false, has_part_ = false, waits_ = false;
  std::size_t picture_left_ = 0;
};

double computeQuantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST(PicturePacer, AFrameWaitsLittleAtEveryRateAndDelay) {
  for (const double rate_Mbit_s : {0.5, 1.0, 1.5, 4.0, 10.0, 100.0}) {
    for (const int delay_ms : {1, 10, 75, 150}) {
      for (const double loss : {0.0, 0.01}) {
        const double rate_B_s = rate_Mbit_s * 125e3;
        const Simulated result =
            LinkSimulation({rate_B_s, milliseconds(delay_ms), loss}).run(kPlayed);
        const double p99_ms = computeQuantile(result.waits_ms, 0.99);
        const double free_B_s = std::min(rate_B_s - kFrames_B_s, kPictures_B_s);
        const double share = result.picture_bytes / toSeconds(kPlayed) / free_B_s;
        const std::string link = fmt::format("{} Mbit/s, {} ms, loss {}: p99 {:.0f} ms, {:.0f} %",
                                             rate_Mbit_s, delay_ms, loss, p99_ms, 100.0 * share);
        EXPECT_LE(p99_ms, 50.0) << link;
        EXPECT_GE(share, loss > 0.0 ? 0.1 : 0.4) << link;
      }
    }
  }
}

/// The rate falls to an eighth, as where a phone leaves its Wi-Fi.
TEST(PicturePacer, ALinkThatBecomesSlowHasNoStandingQueueSoonAfter) {
  LinkSimulation simulation({500e3, milliseconds(40)});
  (void)simulation.run(std::chrono::seconds(10));
  simulation.setRate_bytes_s(62.5e3);
  (void)simulation.run(std::chrono::seconds(12));
  const std::size_t before = simulation.result().waits_ms.size();
  (void)simulation.run(std::chrono::seconds(22));
  std::vector<double> waits_ms = simulation.result().waits_ms;
  waits_ms.erase(waits_ms.begin(), waits_ms.begin() + static_cast<std::ptrdiff_t>(before));
  EXPECT_LE(computeQuantile(waits_ms, 0.99), 60.0);
}

TEST(PicturePacer, AViewerThatConfirmsNothingGetsTheFirstWindowAlone) {
  PicturePacer pacer;
  LocalTime now{};
  double sent_bytes = 0.0;
  for (int i = 0; i < 10'000; ++i, now += milliseconds(1)) {
    const std::size_t part = pacer.computePartBytes(now);
    if (part > 0) pacer.onSent(part, now);
    sent_bytes += static_cast<double>(part);
  }
  EXPECT_LE(sent_bytes, PicturePacer::kFirstWindowBytes + PicturePacer::kMinPartBytes);
}

TEST(PicturePacer, FalseReceiptsChangeNothing) {
  PicturePacer pacer;
  std::mt19937_64 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const LocalTime now{milliseconds(i)};
    const std::size_t part = pacer.computePartBytes(now);
    EXPECT_LE(part, limits::kPicturePart);
    if (part > 0) pacer.onSent(part, now);
    pacer.onReceipt({random() >> (random() % 64), microseconds(random() % 10'000'000)}, now);
    EXPECT_TRUE(std::isfinite(pacer.computeRate_bytes_s()));
  }
}

}  // namespace
}  // namespace hapticast::server
