// SPDX-License-Identifier: MIT
// Selection of the transport: multicast, UDP, or TCP as the fallback. While the selector tries
// multicast or UDP, the server still sends the frames over TCP. When frames arrive by the new
// transport, the client stops those of TCP. After a failure the selector tries the next transport,
// and after half a minute the first one again. Times are arguments.
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

/// The transports, in the order of preference.
enum class Transport : std::uint8_t { kGroup, kDatagrams, kTcp };
/// Names of the transports on the command line and in the summary.
inline constexpr std::array<const char*, 3> kWayNames{"multicast", "udp", "tcp"};
constexpr const char* transportName(Transport transport) noexcept {
  return kWayNames[static_cast<std::size_t>(transport)];
}

/// Settings of the delivery: how frames reach this client.
struct DeliverySettings {
  /// The transport to try first; kGroup falls back to kDatagrams, and that to kTcp.
  Transport best = Transport::kDatagrams;
  std::uint32_t copies = 0;  ///< number of times that each datagram is sent; 0: automatic
  /// Network interface on which the client joins the multicast group, by name or address. Empty:
  /// the interface of the route to the server.
  std::string interface_name{};
};

/// The present transport and its quality.
struct DeliveryStats {
  Transport transport = Transport::kTcp;
  double loss = 0.0;         ///< share of the datagrams that were lost, 0..1, as last measured
  std::uint32_t copies = 1;  ///< number of times that each datagram is sent
};

/// Decides which transport to use. It opens no sockets: UdpReceiver reports events to it and
/// carries out its decisions.
class TransportSelector {
 public:
  /// A new transport counts as failed if frames arrive only over TCP for this time.
  static constexpr Duration kPatience = std::chrono::seconds(1);
  /// A transport that has worked is suspected if it delivers no frame for this time, and for
  /// kSilentFrames frame intervals. The values are a choice: the force begins to fade 0.4 s after
  /// the last frame, and bursts of losses are shorter.
  static constexpr Duration kSilence = std::chrono::milliseconds(400);
  static constexpr int kSilentFrames = 4;
  /// A suspected transport counts as failed if frames arrive only over TCP for this time. The value
  /// is a choice: the largest difference between the delays of two working transports.
  static constexpr Duration kRace = std::chrono::milliseconds(200);
  /// Time from a failure until the selector tries the first transport again.
  static constexpr Duration kTryAgain = std::chrono::seconds(30);
  /// A transport counts as failed if it delivers frames for this time, but no probe. A probe is a
  /// datagram of full size. The value is a choice: the time in which a multicast group sends four
  /// probes.
  static constexpr Duration kProbePatience = std::chrono::seconds(2);

  /// `transports` are the available transports, in the order of preference. The last one must be
  /// kTcp.
  explicit TransportSelector(std::vector<Transport> transports);

  /// Returns the transport that is in use or being tried.
  [[nodiscard]] Transport transport() const { return transports_[at_]; }
  /// Returns true if complete frames arrive by this transport. Then the frames over TCP are
  /// unnecessary.
  [[nodiscard]] bool works() const { return works_; }

  /// Registers that a probe (a datagram of full size) has arrived.
  void probed() { probed_ = true; }
  /// Returns true if a probe has arrived by the present transport.
  [[nodiscard]] bool wasProbed() const { return probed_; }
  /// Registers a complete frame that arrived by the present transport.
  void onCompleteFrame(std::uint64_t id, LocalTime now);
  /// Registers a frame that arrived over TCP.
  void tcpFrame(std::uint64_t id, LocalTime now);
  /// Ends the use of the present transport and tries the next one. Call it if the transport cannot
  /// be opened, is flooded by unauthentic datagrams, or delivers no frames. `why` is the reason for
  /// the user.
  void markFailed(const std::string& why, LocalTime now);
  /// Checks all time limits. `copies` is the redundancy that the client requests from the server.
  void update(LocalTime now, std::uint32_t copies, Duration frame_interval);

  /// Returns a new request to the server, once for each change. Returns nullopt if nothing has
  /// changed.
  [[nodiscard]] std::optional<Delivery> takeRequest();
  /// Returns a new message for the user, once for each change. Returns nullopt if nothing has
  /// changed.
  [[nodiscard]] std::optional<std::string> nextMessage();

 private:
  void begin(std::size_t at);
  /// Returns true if `id` is newer than all complete frames of this transport. It also returns true
  /// if the server has restarted its numbering.
  [[nodiscard]] bool isNewer(std::uint64_t id) const;
  [[nodiscard]] Delivery wanted() const;

  std::vector<Transport> transports_;
  std::size_t at_ = 0;
  bool works_ = false;
  bool suspected_ = false;  // the transport has worked, and then delivered nothing for a while
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
