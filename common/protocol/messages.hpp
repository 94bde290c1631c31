// SPDX-License-Identifier: MIT
// Protocol messages as structs, with their encoder and decoder. Only this folder includes protobuf.
// The decoder checks all input, so its results are finite, within range and consistent. The format
// is in proto/README.md. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/result.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/seal.hpp"
#include "common/transport/signature.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// Protocol version. A developer increments it at every incompatible change of
/// proto/hapticast.proto.
inline constexpr std::uint32_t kProtocolVersion = 3;

/// First message of a client.
struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::string client_name;
  bool wants_video = false;
  bool wants_frames_on_tcp = true;
  std::string access_token = {};       ///< secret of the user; empty: none
  bool accepts_picture_parts = false;  ///< pictures may come as PicturePart; Receipts follow
  bool wants_acts = false;             ///< an operator that receives the acts of other operators
};
/// Key of the sealed datagrams (proto/datagrams.md).
struct DatagramKey {
  std::uint8_t id = 1;  ///< 1..255
  SealKeyBytes bytes{};
  Duration grace{};  ///< how long datagrams under the keys before stay valid
  bool operator==(const DatagramKey&) const = default;
};
/// A multicast group to which the server sends the stream.
struct DatagramGroup {
  std::string address;
  std::uint16_t port = 0;
  std::uint64_t token = 0;
  bool operator==(const DatagramGroup&) const = default;
};
/// Answer of the server to Hello. It announces the stream.
struct Welcome {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t session_id = 0;
  std::uint64_t datagram_token = 0;  ///< 0: the server sends no datagrams
  StreamDescription description;
  std::uint16_t datagram_port = 0;  ///< 0: the port of the TCP connection
  /// Number of this run of the server. Every datagram has it, and it is part of each signature.
  std::uint32_t stream = 0;
  /// Key of the signatures. Where it is present, every frame is signed. Datagrams need it.
  std::optional<KeyBytes> verifying_key = std::nullopt;
  std::optional<DatagramGroup> group = std::nullopt;
  std::optional<DatagramKey> datagram_key = std::nullopt;  ///< absent: datagrams are not sealed
};
/// Request of an operator. The server sends it back to the operator when it has accepted the
/// request, and to other operators with name and time.
struct Control {
  std::optional<bool> paused;
  std::optional<double> seek_s;  ///< time in the clip, s
  Material material;             ///< its values replace those of all objects
  /// Speed of a recording, limits::kLeastSpeed..kMostSpeed; other sources ignore it.
  std::optional<double> speed = std::nullopt;
  /// Number of viewers. The server sets it for an operator; other values are ignored.
  std::optional<std::uint32_t> viewers = std::nullopt;
  /// Name of the operator, in the copy for another operator. The server sets it.
  std::string operator_name = {};
  /// Media time at which the server had carried the request out, in the copy for another operator.
  std::optional<MediaTime> at = std::nullopt;
  bool operator==(const Control&) const = default;
};
/// Request of a client: transport and redundancy of its frames from now on.
struct Delivery {
  bool on_tcp = true;
  bool datagrams = true;  ///< true: send datagrams once the client has returned its token (echo)
  /// Number of times that the server sends each datagram, 1..limits::kMostCopies. A client of the
  /// multicast group states the number that it needs.
  std::uint32_t copies = 1;
  std::optional<bool> pictures = std::nullopt;  ///< absent: as before
  bool operator==(const Delivery&) const = default;
};
/// Request of a client for the server's time.
struct Ping {
  LocalTime t0;
};
/// Answer of the server to a ping (transport/clock_sync.hpp).
struct Pong {
  LocalTime t0;
  MediaTime t1;
  MediaTime t2;
  /// Largest error of t1 and t2 against the clock of the frames, 0..limits::kClockError_ns.
  Duration error{};
};
/// Statistics of a client about its reception, like the receiver reports of RTCP. A client sends
/// them about once a second.
struct ReceiverReport {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  double playout_delay_ms = 0.0;
  double clock_error_us = 0.0;
  bool in_contact = false;
};

/// The next bytes of a picture, of which the first part announces the size.
struct PicturePart {
  std::uint32_t size = 0;  ///< in the first part: bytes of the message with the picture; else 0
  std::vector<std::uint8_t> data;  ///< 1..limits::kPicturePart bytes
  bool reduced = false;  ///< the link carries fewer or coarser pictures than the stream has
};
/// Confirmation of a client: what has arrived. The server computes from it how fast the link is.
struct Receipt {
  std::uint64_t bytes = 0;  ///< payloads of the session, summed
  Duration held{};          ///< from the arrival of the last of them to this message
};

/// Progress of the server's scan of its clip. The server sends no frames before the end of the
/// scan.
struct Preparing {
  double share = 0.0;  ///< scanned share, 0..1
};

using Message = std::variant<Hello, Welcome, Ping, Pong, StreamDescription, CodedFrame, VideoFrame,
                             ReceiverReport, WireError, Preparing, Delivery, DatagramKey, Control,
                             PicturePart, Receipt>;

/// Returns the bytes of one message, without the length prefix (framing.hpp). Requires valid
/// content.
[[nodiscard]] std::vector<std::uint8_t> encode(const Message& message);

/// Returns the bytes of one message in a form that several senders can share.
[[nodiscard]] SharedBytes encodeShared(const Message& message);

/// Decodes one message and returns it. Returns an error for invalid bytes, and never throws for
/// them. It checks all limits before it allocates memory for the content. It checks only the
/// headers of slices; HeightDecoder checks the rest.
[[nodiscard]] Result<Message, WireError> decode(std::span<const std::uint8_t> bytes);

}  // namespace hapticast
