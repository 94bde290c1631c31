// SPDX-License-Identifier: MIT
// UDP fan-out: sends a frame's datagrams over one socket to all targets, many in one system call
// (sendmmsg). A datagram consists of its target's token and a body. All targets share the bodies.
// Datagrams of one target and one size form a single message. The kernel splits the message into
// datagrams (UDP_SEGMENT, generic segmentation offload). That halves the CPU time
// (server/stream/README.md). A *round* is the set of datagrams of one call of send(): those of the
// newest frame, and those of earlier frames again for redundancy. If the socket is full, the rest
// of the round waits. The next round replaces that rest, because its frames are newer. So UdpFanout
// never blocks and stores only one round. Thread: the network's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Counts of datagrams to one viewer, or to the multicast group.
struct DatagramCounts {
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;  ///< replaced by a newer frame before the system accepted them
  std::uint64_t failed = 0;   ///< rejected by the system
  std::uint64_t bytes = 0;    ///< of those that were sent, without the headers of IP and UDP

  DatagramCounts& operator+=(const DatagramCounts& other);
};

/// A receiver of datagrams: a viewer, or the multicast group. `token` precedes each datagram.
/// UdpFanout adds to `counts`, which send() requires.
struct DatagramTarget {
  std::uint64_t token = 0;
  asio::ip::udp::endpoint to;  ///< address of the receiver, of the same IP version as the socket
  asio::ip::address from;      ///< source address on this machine; unspecified: the system chooses
  std::uint32_t copies = 1;    ///< redundancy: how many frames of a round it receives, newest first
  std::shared_ptr<DatagramCounts> counts;
};

/// Sends datagrams over one socket to many targets.
class UdpFanout {
 public:
  /// Largest number of datagrams in one system call.
  static constexpr std::size_t kBatch = 64;
  /// Largest number of datagrams that the kernel splits from one message. The kernel itself allows
  /// 64, and 65,507 bytes in all.
  static constexpr std::size_t kMostSegments = kBatch / 2;
  /// Number of datagrams after which other work of the thread runs. The value is a choice: about 2
  /// ms of work.
  static constexpr std::size_t kAtOnce = 1024;

  /// Sends over `socket`, which must be open and non-blocking. The socket and its io_context must
  /// outlive UdpFanout.
  explicit UdpFanout(asio::ip::udp::socket& socket);
  UdpFanout(const UdpFanout&) = delete;
  UdpFanout& operator=(const UdpFanout&) = delete;
  ~UdpFanout();

  /// Begins a round. Each target receives the datagrams of the first `copies` frames of
  /// `newest_first`. Datagrams of the previous round that have not been sent are dropped.
  void send(std::vector<SignedDatagrams> newest_first, const std::vector<DatagramTarget>& targets);
  /// Drops the datagrams of the round that have not been sent.
  void dropRest();
  /// Sends one datagram at once, before the rest of the round. Returns false if the system rejects
  /// it.
  bool sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target);

 private:
  struct Batch;
  /// Address and token of a target, as the system calls need them.
  struct Address;
  /// Bodies of one message. All have the same size, but the last one may be shorter.
  using Segments = std::vector<const std::vector<std::uint8_t>*>;
  /// Position in a round: a message of a frame, and its target.
  struct Cursor {
    std::size_t frame = 0, message = 0, target = 0;
  };

  /// Returns a frame's bodies, grouped into as few messages as possible.
  [[nodiscard]] static std::vector<Segments> splitSegments(const SignedDatagrams& bodies);
  [[nodiscard]] const Segments& at(const Cursor& cursor) const {
    return messages_[cursor.frame][cursor.message];
  }
  /// sendSingly() sends the datagrams of a message one by one, for a system that does not split
  /// messages. sendOne() sends one datagram. It returns the sent bytes; 0: the system rejects it.
  std::size_t sendOne(const std::vector<std::uint8_t>& body, Address& to);
  void sendSingly(const Segments& segments, Address& to);

  /// Moves `cursor` to the next message and target, unless it already points to one. Returns false
  /// at the end of the round.
  [[nodiscard]] bool finishRound(Cursor& cursor) const;
  /// Sends the rest of the round until it ends, the socket is full, or kAtOnce datagrams are sent.
  void sendPending();
  /// Calls sendPending() as soon as the socket accepts datagrams again.
  void scheduleSend();
  /// Sends the next messages in one system call: at least one message, and at most kBatch
  /// datagrams. Returns false if the socket is full.
  bool sendBatch();

  asio::ip::udp::socket& socket_;
  std::unique_ptr<Batch> batch_;
  std::vector<SignedDatagrams> frames_;
  std::vector<std::vector<Segments>> messages_;  // messages of each frame
  std::vector<Address> targets_;
  Cursor next_;
  bool waiting_ = false;  // a call of sendPending() is scheduled
};

}  // namespace hapticast::server
