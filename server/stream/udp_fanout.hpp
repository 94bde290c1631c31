// SPDX-License-Identifier: MIT
// Sends a frame's datagrams over one UDP socket to all who take them, as fast as the system takes
// them and no faster: many in one call, each body shared, the token of its viewer in front. Those
// of one viewer and one size go as a single message that the system cuts (UDP_SEGMENT), which costs
// about half of what they cost one by one (server/README.md). What the system does not take at once
// waits until the next frame, which is newer and wins. Never blocks, keeps one round. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Of one viewer, or of the group.
struct DatagramCounts {
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;  ///< a newer frame came before the system took them
  std::uint64_t failed = 0;   ///< the system refused them

  DatagramCounts& operator+=(const DatagramCounts& other);
};

/// Who gets datagrams.
struct DatagramTarget {
  std::uint64_t token = 0;
  asio::ip::udp::endpoint to;  ///< of the socket's kind
  asio::ip::address from;      ///< one of this machine's; unspecified: the system chooses
  std::uint32_t copies = 1;    ///< frames of a round that it gets, the newest first
  std::shared_ptr<DatagramCounts> counts;
};

class UdpFanout {
 public:
  /// Datagrams in one system call.
  static constexpr std::size_t kBatch = 64;
  /// Datagrams that the system cuts from one message; it takes 64, and 65,507 bytes in all.
  static constexpr std::size_t kMostSegments = kBatch / 2;
  /// Chosen: some 2 ms of work, then others on the thread have their turn.
  static constexpr std::size_t kAtOnce = 1024;

  /// The socket is open, does not block, and outlives this; so does its io_context.
  explicit UdpFanout(asio::ip::udp::socket& socket);
  UdpFanout(const UdpFanout&) = delete;
  UdpFanout& operator=(const UdpFanout&) = delete;
  ~UdpFanout();

  /// Begins a round: the datagrams of `newest_first`, each frame's to whom it goes. What is left of
  /// the round before is dropped.
  void send(std::vector<SignedDatagrams> newest_first, const std::vector<DatagramTarget>& targets);
  /// Drops what is left of the round.
  void dropRest();
  /// Sends one datagram now; false where the system does not take it.
  bool sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target);

 private:
  struct Batch;
  /// A target as the system wants it.
  struct Address;
  /// Bodies that go as one message: of one size, but the last may be shorter.
  using Segments = std::vector<const std::vector<std::uint8_t>*>;
  /// The next message of the round.
  struct Cursor {
    std::size_t frame = 0, message = 0, target = 0;
  };

  /// A frame's bodies as few messages.
  [[nodiscard]] static std::vector<Segments> splitSegments(const SignedDatagrams& bodies);
  [[nodiscard]] const Segments& at(const Cursor& cursor) const {
    return messages_[cursor.frame][cursor.message];
  }
  /// What the system does not cut: each datagram by itself.
  bool sendOne(const std::vector<std::uint8_t>& body, Address& to);
  void sendSingly(const Segments& segments, Address& to);

  /// Whether there is a message at the cursor; moves it over those that nobody wants.
  [[nodiscard]] bool finishRound(Cursor& cursor) const;
  void sendPending();
  void scheduleSend();
  /// Sends up to kBatch datagrams, at least one message; false where the system takes no more for
  /// now.
  bool sendBatch();

  asio::ip::udp::socket& socket_;
  std::unique_ptr<Batch> batch_;
  std::vector<SignedDatagrams> frames_;
  std::vector<std::vector<Segments>> messages_;  // of each frame
  std::vector<Address> targets_;
  Cursor next_;
  bool waiting_ = false;  // something will call go()
};

}  // namespace hapticast::server
