// SPDX-License-Identifier: MIT
// Somebody who reads along on this machine and forges: sees a datagram from a server to a viewer,
// and sends its own as if they came from the server. Needs the right to raw sockets. IPv4. Thread:
// one.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"

namespace hapticast::testing {

/// The forger's knowledge of the stream.
enum class Knows {
  kNothing,  ///< but where the viewer is: its datagrams come from a port of its own
  kAddress,  ///< and the server's address, which it forges
  kToken,    ///< and token, stream and the ids of the frames that come
};

class Eavesdropper {
 public:
  /// Throws std::runtime_error with one line.
  explicit Eavesdropper(std::uint16_t server_port);

  /// Whether it has seen the server's datagrams to the viewer.
  bool listen();
  /// As many datagrams as `rate_Hz` asks for since the last call, to the viewer, or to a port of
  /// its machine at which nobody listens.
  void flood(Knows knows, bool at_closed_port, double rate_Hz, LocalTime now);
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  Eavesdropper(const Eavesdropper&) = delete;
  Eavesdropper& operator=(const Eavesdropper&) = delete;
  ~Eavesdropper();

 private:
  std::vector<std::uint8_t> forged(Knows knows);

  std::uint16_t server_port_;
  int raw_ = -1;
  asio::io_context io_;
  asio::ip::udp::socket own_{io_};     // from a port of its own
  asio::ip::udp::socket closed_{io_};  // holds the number of a port, closed before the flood
  std::uint16_t viewer_port_ = 0;
  std::uint16_t closed_port_ = 0;
  std::uint64_t token_ = 0;
  DatagramHeader newest_;
  SigningKey another_key_;
  std::optional<LocalTime> begun_at_;
  std::uint64_t tried_ = 0;  // since then, or left out as too many at once
  std::uint64_t sent_ = 0;
  std::mt19937_64 random_{5};
};

}  // namespace hapticast::testing
