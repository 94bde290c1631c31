// SPDX-License-Identifier: MIT
// A server and a network in virtual time: a stream's frames as they leave the server, over TCP or
// as datagrams, through a link each way. Thread: one.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/datagram.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"
#include "tests/support/link_model.hpp"

namespace hapticast::evaluate {

/// The path between a server and a viewer.
struct Network {
  bool datagrams = true;      ///< else all travels over TCP
  std::uint32_t copies = 0;   ///< of each datagram; 0: as many as the loss asks for
  testing::LinkProfile link;  ///< each way
  double drift = 0.0;         ///< the server's clock gains so many seconds a second
  double cut_from_s = 1e9;    ///< from here on nothing passes: datagrams are lost, TCP waits
  double cut_s = 0.0;
};

/// A stream cut into messages and datagrams.
class SentStream {
 public:
  explicit SentStream(const Stream& stream);

  struct Part {
    DatagramHeader header;
    std::vector<std::uint8_t> payload;
  };
  struct Frame {
    double time_s = 0.0;  ///< of the media clock
    SharedBytes message;
    std::vector<Part> parts;
  };
  StreamDescription description;
  std::vector<Frame> frames;
  double bytes_per_frame = 0.0;  ///< of its datagrams, once each
};

class Wire {
 public:
  /// The viewer's connection is made at `start`, when the server's media clock says 0. The stream
  /// outlives it.
  Wire(const SentStream& stream, const Network& network, LocalTime start);

  void ping(const Ping& ping);
  /// The viewer asks for so many copies.
  void order(std::uint32_t copies, LocalTime now);

  struct Events {
    std::function<void(LocalTime)> at;                           ///< comes first: when it arrives
    std::function<void(std::span<const std::uint8_t>)> message;  ///< over TCP
    std::function<void(const SentStream::Part&)> part;
  };
  /// What has arrived by now, in its order.
  void deliver(LocalTime now, const Events& events);
  /// The server's media clock.
  [[nodiscard]] MediaTime mediaNow(LocalTime now) const;
  /// Of all of which anything has come.
  [[nodiscard]] MediaTime newest() const { return newest_; }
  /// How long each frame was under way, ms: the last of its datagrams, the first time they are
  /// sent.
  [[nodiscard]] const std::vector<double>& waited_ms() const { return waited_ms_; }

 private:
  using Arrival = std::function<void(const Events&)>;
  /// When the server's clock says so.
  [[nodiscard]] LocalTime localAt(double media_s) const;
  void send(std::size_t frame);
  void arrive(LocalTime at, const SentStream::Frame& frame, Arrival arrival);
  /// TCP stands still in a cut.
  [[nodiscard]] LocalTime afterCut(LocalTime at) const;
  [[nodiscard]] bool isCut(LocalTime at) const;

  const SentStream& stream_;
  Network network_;
  LocalTime start_;
  testing::LinkWay up_;
  testing::LinkWay down_;
  testing::LinkModel up_stream_;
  testing::LinkModel down_stream_;
  testing::LinkModel down_datagrams_;
  std::multimap<LocalTime, Arrival> under_way_;
  std::uint32_t copies_ = 1;  // as the server knows it
  std::size_t next_ = 0;
  MediaTime newest_{};
  std::vector<double> waited_ms_;
};

}  // namespace hapticast::evaluate
