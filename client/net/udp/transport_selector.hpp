// SPDX-License-Identifier: MIT
// Selection of the transport: multicast, UDP, or TCP as the fallback. A transport is used once it
// has worked while another one still delivers. After a failure the next one is tried, and half a
// minute later the best one again. Times are arguments.
// Thread: network.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Transports, best first.
enum class Transport : std::uint8_t { kGroup, kDatagrams, kTcp };
/// Names on the command line and in the summary.
inline constexpr std::array<const char*, 3> kWayNames{"multicast", "udp", "tcp"};
constexpr const char* transportName(Transport transport) noexcept {
  return kWayNames[static_cast<std::size_t>(transport)];
}

/// Settings of the delivery.
struct DeliverySettings {
  Transport best = Transport::kDatagrams;  ///< kGroup falls back to kDatagrams, kDatagrams to kTcp
  std::uint32_t copies = 0;                ///< redundancy; 0: automatic
  /// Network interface of the group, by name or address; empty: that of the route to the server.
  std::string interface_name{};
};

/// Present delivery.
struct DeliveryStats {
  Transport transport = Transport::kTcp;
  double loss = 0.0;         ///< loss of datagrams, 0..1, as last measured
  std::uint32_t copies = 1;  ///< redundancy
};

/// State machine of the selection.
class TransportSelector {
 public:
  /// Patience with a transport while frames arrive only over TCP. A transport that worked until now
  /// has this time to resume. Then the next frames over TCP end it.
  static constexpr Duration kPatience = std::chrono::seconds(1);
  /// Largest difference of the delays of two working transports. Chosen.
  static constexpr Duration kRace = std::chrono::milliseconds(200);
  static constexpr Duration kTryAgain = std::chrono::seconds(30);
  /// Longest time with frames but without a probe. Chosen: four probes of a group.
  static constexpr Duration kProbePatience = std::chrono::seconds(2);

  /// `ways` are the available transports, best first. Requires kTcp as the last one.
  explicit TransportSelector(std::vector<Transport> transports);

  /// The transport in use or on trial.
  [[nodiscard]] Transport transport() const { return transports_[at_]; }
  /// Returns true if complete frames arrive by this transport, so that TCP's are unnecessary.
  [[nodiscard]] bool works() const { return works_; }

  /// Registers a datagram of full size.
  void probed() { probed_ = true; }
  [[nodiscard]] bool wasProbed() const { return probed_; }
  /// Registers a complete frame that arrived by this transport.
  void onCompleteFrame(std::uint64_t id, LocalTime now);
  /// Registers a frame that arrived over TCP.
  void tcpFrame(std::uint64_t id, LocalTime now);
  /// Ends the present transport: it cannot be opened, is flooded, or delivers no frames.
  void markFailed(const std::string& why, LocalTime now);
  /// Checks all timeouts. `copies` is the redundancy to request.
  void update(LocalTime now, std::uint32_t copies);

  /// Returns a new request to the server, once for each change.
  [[nodiscard]] std::optional<Delivery> takeRequest();
  /// Returns a new message for the user, once for each change.
  [[nodiscard]] std::optional<std::string> nextMessage();

 private:
  void begin(std::size_t at);
  /// Returns true if `id` is newer than all complete frames of this transport, or belongs to a new
  /// numbering.
  [[nodiscard]] bool newer(std::uint64_t id) const;
  [[nodiscard]] Delivery wanted() const;

  std::vector<Transport> transports_;
  std::size_t at_ = 0;
  bool works_ = false;
  bool suspected_ = false;  // the transport worked, and was silent for a while
  bool probed_ = false;
  std::uint64_t newest_ = 0;                 // newest complete frame by this transport
  LocalTime received_at_{};                  // arrival of that frame
  std::optional<LocalTime> narrow_since_;    // complete frames arrive, but no probe
  std::optional<LocalTime> only_tcp_since_;  // frames arrive over TCP only
  LocalTime failed_at_{};                    // last failure of a transport
  std::uint32_t copies_ = 1;
  std::optional<Delivery> ordered_;
  std::vector<Transport> logged_;  // transports whose failure was reported
  std::string messages_;
};

}  // namespace hapticast::client
