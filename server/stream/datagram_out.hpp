// SPDX-License-Identifier: MIT
// Sends a frame's datagrams over one UDP socket to all who take them, as fast as the system takes
// them and no faster: many in one call, each body shared, the token of its viewer in front. What
// the system does not take at once waits until the next frame, which is newer and wins. Never
// blocks, keeps one round. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/wire/asio.hpp"
#include "common/wire/datagram.hpp"
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
  asio::ip::udp::endpoint to;
  asio::ip::address from;    ///< one of this machine's; unspecified: the system chooses
  std::uint32_t copies = 1;  ///< frames of a round that it gets, the newest first
  std::shared_ptr<DatagramCounts> counts;
};

class DatagramOut {
 public:
  /// Messages in one system call.
  static constexpr std::size_t kBatch = 64;
  /// Chosen: some 2 ms of work, then others on the thread have their turn.
  static constexpr std::size_t kAtOnce = 1024;

  /// The socket is open, does not block, and outlives this; so does its io_context.
  explicit DatagramOut(asio::ip::udp::socket& socket);
  DatagramOut(const DatagramOut&) = delete;
  DatagramOut& operator=(const DatagramOut&) = delete;
  ~DatagramOut();

  /// Begins a round: the datagrams of `newest_first`, each frame's to whom it goes. What is left of
  /// the round before is dropped.
  void send(std::vector<SharedBodies> newest_first, const std::vector<DatagramTarget>& targets);
  /// Sends one datagram now; false where the system does not take it.
  bool sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target);
  /// Drops what waits.
  void stop();

 private:
  struct Batch;
  /// A target as the system wants it.
  struct Address;
  /// The next message of the round.
  struct Cursor {
    std::size_t frame = 0, body = 0, target = 0;
  };

  /// Whether there is a message at the cursor; moves it over those that nobody wants.
  [[nodiscard]] bool settle(Cursor& cursor) const;
  void dropRest();
  void go();
  void goLater();
  /// Sends up to kBatch messages; false where the system takes no more for now.
  bool sendBatch();

  asio::ip::udp::socket& socket_;
  std::unique_ptr<Batch> batch_;
  std::vector<SharedBodies> frames_;
  std::vector<Address> targets_;
  Cursor next_;
  bool waiting_ = false;  // something will call go()
};

}  // namespace hapticast::server
