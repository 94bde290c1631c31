// SPDX-License-Identifier: MIT
#include "server/stream/picture_pacer.hpp"

#include <algorithm>

#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A burst is half of kMostWait, a standing queue less than the rest.
constexpr Duration kBurst = milliseconds(20);
constexpr Duration kMostQueue = milliseconds(12);
constexpr Duration kLeastQueue = milliseconds(5);  // chosen: a round with less lets the window grow
// Chosen: two frames at 25 frames/s. Within them the queue behind a large frame becomes empty.
constexpr Duration kLeastRound = milliseconds(80);
// Longest age of the shortest round trip, as in BBR. After it parts wait for a round.
constexpr Duration kShortestAge = seconds(10);
constexpr Duration kJitter = milliseconds(2);  // chosen: of a receipt's way through two programs
constexpr double kFastGrowth = 0.25;    // of a round; doubling fills the queue of a slow link
constexpr double kGrowth = 1.0 / 16.0;  // chosen
constexpr double kBackOff = 0.8;  // chosen; with the 0.7 of CUBIC pictures recover more slowly
constexpr double kMostWindowBytes = 4U << 20U;
constexpr double kPacingGain = 1.05;  // as in BBR: a sampled rate can grow by it
constexpr double kProbingGain = 1.5;
constexpr Duration kRateAge = seconds(1);
constexpr Duration kLeastInterval = milliseconds(1);  // of a rate's sample; the clocks' resolution
constexpr std::size_t kMostSent = 1024;  // messages on their way; chosen: 5 s of frames and parts

}  // namespace

void PicturePacer::onSent(std::size_t bytes, LocalTime now) {
  if (!begun_) {
    received_bytes_ = sent_bytes_ += bytes;  // the viewer confirms nothing yet
    return;
  }
  if (sent_bytes_ == received_bytes_) received_at_ = first_sent_ = now;  // nothing was on its way
  sent_bytes_ += bytes;
  refill(now);
  tokens_bytes_ -= static_cast<double>(bytes);
  if (sent_.size() < kMostSent)
    sent_.push_back({sent_bytes_, bytes, now, received_bytes_, received_at_, first_sent_});
}

void PicturePacer::onReceipt(const Receipt& receipt, LocalTime now) {
  if (receipt.bytes <= received_bytes_ || receipt.bytes > sent_bytes_) return;
  const LocalTime arrived = now - receipt.held;
  received_bytes_ = receipt.bytes;
  received_at_ = arrived;
  std::optional<Sent> last;
  for (; !sent_.empty() && sent_.front().end_bytes <= receipt.bytes; sent_.pop_front())
    last = sent_.front();
  if (!last || arrived < last->time) return;
  first_sent_ = last->time;
  addRate(*last, receipt.bytes, arrived);
  // A larger message spends longer on a slow link by itself, which is no queue.
  if (static_cast<double>(last->bytes) <= computeLargestPart_bytes())
    addRoundTrip(arrived - last->time, now);
  checkQueue(now);
}

void PicturePacer::addRate(const Sent& sent, std::uint64_t bytes, LocalTime arrived) {
  const Duration interval =
      std::max({arrived - sent.received_at, sent.time - sent.first_sent, Duration(kLeastInterval)});
  if (arrived - rates_begin_ >= kRateAge) {
    rates_B_s_ = {0.0, rates_B_s_[0]};
    rates_begin_ = arrived;
  }
  const double rate_B_s = static_cast<double>(bytes - sent.received_bytes) / toSeconds(interval);
  rates_B_s_[0] = std::max(rates_B_s_[0], rate_B_s);
}

double PicturePacer::computeRate_bytes_s() const { return std::max(rates_B_s_[0], rates_B_s_[1]); }

void PicturePacer::addRoundTrip(Duration round_trip, LocalTime now) {
  if (now < drains_until_ || round_trip - kJitter <= shortest_) shortest_at_ = now;
  shortest_ = std::min(shortest_, round_trip);
  recent_shortest_ = std::min(recent_shortest_, round_trip);
  if (now - shortest_at_ < kShortestAge) return;
  shortest_ = Duration::max();
  shortest_at_ = now;
  drains_until_ = now + std::max<Duration>(round_trip, kLeastRound);
}

void PicturePacer::checkQueue(LocalTime now) {
  if (now - checked_ < kLeastRound) return;
  const bool is_known = recent_shortest_ != Duration::max();
  const Duration queue = is_known ? recent_shortest_ - shortest_ : Duration{0};
  if (queue > kLeastQueue) probes_ = false;
  if (queue > kMostQueue) {
    window_bytes_ = std::min(window_bytes_, computeRate_bytes_s() * toSeconds(shortest_));
    if (queue > kMostWait) window_bytes_ *= kBackOff;  // the rate has fallen
  }
  round_queue_ = std::max(round_queue_, queue);
  checked_ = now;
  recent_shortest_ = Duration::max();
  if (received_bytes_ < round_end_bytes_) return;
  if (stopped_picture_ && round_queue_ <= kLeastQueue)
    window_bytes_ += (probes_ ? kFastGrowth : kGrowth) * window_bytes_ + kMinPartBytes;
  window_bytes_ = std::clamp(window_bytes_, static_cast<double>(kMinPartBytes), kMostWindowBytes);
  round_end_bytes_ = sent_bytes_;
  round_queue_ = Duration{0};
  stopped_picture_ = false;
}

void PicturePacer::refill(LocalTime now) {
  const double rate_B_s = (probes_ ? kProbingGain : kPacingGain) * computeRate_bytes_s();
  const double most_bytes = rate_B_s > 0.0
                                ? std::max(rate_B_s * toSeconds(kBurst), 2.0 * kMinPartBytes)
                                : kFirstWindowBytes;
  const double added_bytes = rate_B_s * toSeconds(std::min<Duration>(now - refilled_, seconds(1)));
  tokens_bytes_ = std::clamp(tokens_bytes_ + added_bytes, -most_bytes, most_bytes);
  refilled_ = now;
}

double PicturePacer::computeLargestPart_bytes() const {
  return std::clamp(computeRate_bytes_s() * toSeconds(kPartTime),
                    static_cast<double>(kMinPartBytes), static_cast<double>(limits::kPicturePart));
}

std::size_t PicturePacer::computePartBytes(LocalTime now) {
  begun_ = true;
  refill(now);
  const double room_bytes = window_bytes_ - static_cast<double>(sent_bytes_ - received_bytes_);
  const bool has_room = room_bytes >= static_cast<double>(kMinPartBytes);
  if (!has_room) stopped_picture_ = true;
  const double part_bytes = computeLargestPart_bytes();
  if (!has_room || tokens_bytes_ < 0.5 * part_bytes || now < drains_until_) return 0;
  if (part_bytes > room_bytes) stopped_picture_ = true;
  return static_cast<std::size_t>(std::min(part_bytes, room_bytes));
}

}  // namespace hapticast::server
