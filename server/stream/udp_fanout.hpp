// SPDX-License-Identifier: MIT
// UDP fan-out: sends a frame's datagrams over one socket to all subscribers, many in one call
// (sendmmsg), with shared bodies and each viewer's token in front.
// Datagrams of one viewer and one size form a single message that the kernel segments (UDP_SEGMENT,
// generic segmentation offload), at about half the cost (server/README.md).
// Datagrams that the system does not accept wait until the next frame, which is newer and replaces
// them. Never blocks, stores one round. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Counts of one viewer, or of the group.
struct DatagramCounts {
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;  ///< replaced by a newer frame before the system accepted them
  std::uint64_t failed = 0;   ///< rejected by the system

  DatagramCounts& operator+=(const DatagramCounts& other);
};

/// A receiver of datagrams.
struct DatagramTarget {
  std::uint64_t token = 0;
  asio::ip::udp::endpoint to;  ///< same IP version as the socket
  asio::ip::address from;      ///< source address on this machine; unspecified: the system chooses
  std::uint32_t copies = 1;    ///< redundancy: frames of a round to send, newest first
  std::shared_ptr<DatagramCounts> counts;
};

/// Sender over one socket.
class UdpFanout {
 public:
  /// Datagrams in one system call.
  static constexpr std::size_t kBatch = 64;
  /// Datagrams that the kernel segments from one message. Its limits are 64, and 65,507 bytes in
  /// all.
  static constexpr std::size_t kMostSegments = kBatch / 2;
  /// Datagrams before other work on the thread. Chosen: about 2 ms of work.
  static constexpr std::size_t kAtOnce = 1024;

  /// Requires an open, non-blocking socket. The socket and its io_context must outlive UdpFanout.
  explicit UdpFanout(asio::ip::udp::socket& socket);
  UdpFanout(const UdpFanout&) = delete;
  UdpFanout& operator=(const UdpFanout&) = delete;
  ~UdpFanout();

  /// Starts a round: sends each frame of `newest_first` to the targets with enough copies. Drops
  /// the rest of the round before.
  void send(std::vector<SignedDatagrams> newest_first, const std::vector<DatagramTarget>& targets);
  /// Drops the rest of the round.
  void dropRest();
  /// Sends one datagram now. Returns false if the system rejects it.
  bool sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target);

 private:
  struct Batch;
  /// A target in the form of the system calls.
  struct Address;
  /// Bodies of one message: of equal size, except for a shorter last one.
  using Segments = std::vector<const std::vector<std::uint8_t>*>;
  /// Position of the next message in the round.
  struct Cursor {
    std::size_t frame = 0, message = 0, target = 0;
  };

  /// Groups a frame's bodies into few messages.
  [[nodiscard]] static std::vector<Segments> splitSegments(const SignedDatagrams& bodies);
  [[nodiscard]] const Segments& at(const Cursor& cursor) const {
    return messages_[cursor.frame][cursor.message];
  }
  /// Send the datagrams of a message one by one, if the system does not segment it.
  bool sendOne(const std::vector<std::uint8_t>& body, Address& to);
  void sendSingly(const Segments& segments, Address& to);

  /// Moves the cursor to the next message that a target wants. Returns false at the end of the
  /// round.
  [[nodiscard]] bool finishRound(Cursor& cursor) const;
  /// Sends until the round ends, the socket is full, or kAtOnce datagrams are sent.
  void sendPending();
  /// Continues sendPending() when the socket is writable.
  void scheduleSend();
  /// Sends up to kBatch datagrams, at least one message. Returns false if the socket is full.
  bool sendBatch();

  asio::ip::udp::socket& socket_;
  std::unique_ptr<Batch> batch_;
  std::vector<SignedDatagrams> frames_;
  std::vector<std::vector<Segments>> messages_;  // of each frame
  std::vector<Address> targets_;
  Cursor next_;
  bool waiting_ = false;  // a posted call of sendPending() is outstanding
};

}  // namespace hapticast::server
