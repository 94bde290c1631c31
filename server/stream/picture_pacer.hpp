// SPDX-License-Identifier: MIT
// Congestion control of one viewer's pictures, based on delay as in LEDBAT (RFC 6817) and TCP
// Vegas. Frames always leave at once. Parts of pictures leave only while the link's queue is nearly
// empty, so that a frame does not wait behind them.
//
// The viewer confirms what has arrived (Receipt). A round trip above the shortest one is time in a
// queue. The shortest such excess within a round is a standing queue: the window shrinks by it. A
// round without one lets the window grow. A token bucket limits bursts to 20 ms of the link; its
// rate is a delivery rate, sampled as in BBR. Receipts come from the viewer's program, so proxies
// and TLS on the way do not hide the link, as they do from TCP's own figures (TCP_INFO). It has no
// sockets and no clocks. Thread: the network's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "common/protocol/messages.hpp"

namespace hapticast::server {

/// Limits how many bytes of pictures are on their way to one viewer.
class PicturePacer {
 public:
  /// Longest time that a frame may wait for pictures. Chosen: a frame interval at 25 frames/s.
  static constexpr Duration kMostWait = std::chrono::milliseconds(40);
  /// Largest part of a picture in time of the link. Chosen: a frame that waits behind a part waits
  /// no longer than this.
  static constexpr Duration kPartTime = std::chrono::milliseconds(10);
  /// Chosen: below it the header of a part and its packet cost more than a tenth.
  static constexpr std::size_t kMinPartBytes = 600;
  /// Window at the start. Chosen: 33 ms of a link of 0.5 Mbit/s.
  static constexpr double kFirstWindowBytes = 2048.0;

  /// Counts `bytes` of payload that leave at `now`: of frames, parts and all other messages.
  void onSent(std::size_t bytes, LocalTime now);
  /// Processes the viewer's receipt, which arrives at `now`. A receipt of fewer bytes than an
  /// earlier one, or of more than were sent, changes nothing.
  void onReceipt(const Receipt& receipt, LocalTime now);
  /// Returns how many bytes of a picture may leave at `now`, at most limits::kPicturePart; 0: none
  /// before the next receipt or frame. Call it only while a picture waits, because the window grows
  /// if it has stopped a picture.
  [[nodiscard]] std::size_t computePartBytes(LocalTime now);
  /// Returns how many bytes of pictures the link has carried in a second of the last moments; 0:
  /// unknown.
  [[nodiscard]] double computeRate_bytes_s() const;

 private:
  /// A message on its way, with what was known when it left.
  struct Sent {
    std::uint64_t end_bytes;  // of the session, with this message
    std::size_t bytes;
    LocalTime time;
    std::uint64_t received_bytes;  // confirmed by then
    LocalTime received_at;
    LocalTime first_sent;  // of the bytes since received_at
  };

  [[nodiscard]] double computeLargestPart_bytes() const;
  void addRate(const Sent& sent, std::uint64_t bytes, LocalTime arrived);
  void addRoundTrip(Duration round_trip, LocalTime now);
  /// Adapts the window to the queue that stood since the last check.
  void checkQueue(LocalTime now);
  void refill(LocalTime now);

  std::deque<Sent> sent_;
  std::uint64_t sent_bytes_ = 0;
  bool begun_ = false;  // a part has left, so receipts come
  std::uint64_t received_bytes_ = 0;
  LocalTime received_at_{};
  LocalTime first_sent_{};
  Duration shortest_ = Duration::max();  // round trip
  LocalTime shortest_at_{};
  LocalTime drains_until_{};  // parts wait, so that a shortest round trip can be measured
  LocalTime checked_{};
  Duration recent_shortest_ = Duration::max();  // round trip since checked_
  // Of the present round, which ends when all bytes before it are confirmed:
  std::uint64_t round_end_bytes_ = 0;
  Duration round_queue_{0};
  bool stopped_picture_ = false;
  double window_bytes_ = kFirstWindowBytes;
  bool probes_ = true;  // the window grows fast, until the first standing queue
  // Largest rates of the last second and of the one before.
  std::array<double, 2> rates_B_s_{};
  LocalTime rates_begin_{};
  double tokens_bytes_ = kFirstWindowBytes;
  LocalTime refilled_{};
};

}  // namespace hapticast::server
