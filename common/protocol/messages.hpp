// SPDX-License-Identifier: MIT
// Domain structs <-> protobuf bytes. The only door to protobuf; everything read is validated here,
// so what comes out of decode() is finite, within range and consistent. Format: proto/README.md.
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
#include "common/transport/signature.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// Bumped by hand at every incompatible change of proto/hapticast.proto.
inline constexpr std::uint32_t kProtocolVersion = 2;

struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::string client_name;
  bool wants_video = false;
  bool wants_frames_on_tcp = true;
};
/// A multicast group that carries the stream.
struct DatagramGroup {
  std::string address;
  std::uint16_t port = 0;
  std::uint64_t token = 0;
  bool operator==(const DatagramGroup&) const = default;
};
struct Welcome {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t session_id = 0;
  std::uint64_t datagram_token = 0;  ///< 0: no datagrams, and nothing of what follows them
  StreamDescription description;
  std::uint16_t datagram_port = 0;  ///< 0: that of the TCP connection
  std::uint32_t stream = 0;         ///< of this run of the server, in every datagram
  std::optional<KeyBytes> verifying_key = std::nullopt;
  std::optional<DatagramGroup> group = std::nullopt;
};
/// How a client wants its frames from now on.
struct Delivery {
  bool on_tcp = true;
  bool datagrams = true;     ///< where it has echoed its token
  std::uint32_t copies = 1;  ///< of each datagram, 1..limits::kMostCopies; also of the group's
  bool operator==(const Delivery&) const = default;
};
struct Ping {
  LocalTime t0;
};
struct Pong {
  LocalTime t0;
  MediaTime t1;
  MediaTime t2;
};
/// How a client receives, as RTCP's receiver reports say it: now and then, client to server.
struct ReceiverReport {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  double playout_delay_ms = 0.0;
  double clock_error_us = 0.0;
  bool in_contact = false;
};

/// No frame can come yet: the server looks through its clip first.
struct Preparing {
  double share = 0.0;  ///< of the clip, 0..1
};

using Message = std::variant<Hello, Welcome, Ping, Pong, StreamDescription, CodedFrame, VideoFrame,
                             ReceiverReport, WireError, Preparing, Delivery>;

/// The bytes of one message, without the length prefix (framing.hpp). Requires valid content.
[[nodiscard]] std::vector<std::uint8_t> encode(const Message& message);

/// The same, to be shared by all who send them.
[[nodiscard]] SharedBytes encodeShared(const Message& message);

/// Never throws on bad bytes; limits are checked before anything is allocated by content. Slices
/// are checked as far as their first bytes go: whether they can be decoded is HeightDecoder's to
/// say.
[[nodiscard]] Result<Message, WireError> decode(std::span<const std::uint8_t> bytes);

}  // namespace hapticast
