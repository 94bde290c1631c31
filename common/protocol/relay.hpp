// SPDX-License-Identifier: MIT
// Messages between origin and edges (proto/relay.proto; proto/relay.md). A whole message consists
// of magic, channel, term, origin, number, content, and the origin's signature over all of that.
// The origin sends it in numbered pieces, because NATS limits the size of a payload. Decoders check
// limits before they allocate. Thread: any; at most one at a time for each RelayJoiner.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/result.hpp"
#include "common/time.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/signature.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// Largest size of a whole message: the largest frame in its three encoded forms, with a margin.
inline constexpr std::size_t kMostRelayBytes = 4 * kMaxMessageBytes;
/// Largest number of pieces of a message.
inline constexpr std::size_t kMostRelayPieces = 1024;
/// Bytes of a piece before its content.
inline constexpr std::size_t kRelayPieceHeadBytes = 16;

/// Largest lead of a valid term over the seconds since 1970. Terms grow by one with each takeover,
/// and takeovers are at least a second apart. So no message can end all later takeovers.
inline constexpr std::chrono::hours kMostTermLead{24};

/// Identifies a message and its origin.
struct RelayHead {
  std::uint64_t term = 0;  ///< the highest term of a channel determines its active origin
  /// Number of one run of an origin: a random number whose low 32 bits are the stream's. Of two
  /// origins with equal terms, the one with the higher number counts.
  std::uint64_t origin = 0;
  std::uint64_t number = 0;  ///< increases with each message of the origin
  bool operator==(const RelayHead&) const = default;
};

/// Heartbeat of the active origin.
struct RelayState {
  StreamDescription description;
  std::uint32_t stream = 0;
  KeyBytes verifying_key{};
  std::vector<std::uint8_t> probe;  ///< body of a probe, without a token
  bool sealed = false;              ///< whether all datagrams with frames are sealed
  /// Newest key of the sealed datagrams; absent: the origin does not send it.
  std::optional<DatagramKey> datagram_key = std::nullopt;
};
/// A frame in all encoded forms.
struct RelayFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes delta;
  SharedBytes key_frame;  ///< null: the delta frame is a key frame
  /// Signed bodies of the datagrams; null: none.
  std::shared_ptr<const std::vector<std::vector<std::uint8_t>>> datagrams;
  bool too_many_datagrams = false;
};

/// A picture, encoded for all viewers.
struct RelayPicture {
  std::uint64_t id = 0;
  MediaTime media_time;
  SharedBytes message;
};
/// Answer of the active origin to a RelayPing, for the edge's clock (transport/clock_sync.hpp).
struct RelayPong {
  LocalTime t0;  ///< RelayPing::t0, unchanged: the edge's clock
  MediaTime t1;  ///< when the ping arrived: the origin's media clock
  MediaTime t2;  ///< when the origin made this answer: the origin's media clock
};
using RelayContent = std::variant<RelayState, RelayFrame, RelayPicture, RelayPong>;

/// Request of an edge for the origin's time. It is not signed.
struct RelayPing {
  LocalTime t0;
  bool wants_pictures = false;
  bool wants_datagrams = false;
  /// A state of the origin that the edge follows, as a whole signed message. An origin of a lower
  /// term that receives it knows why edges ignore it. Empty: no other origin sends.
  std::vector<std::uint8_t> proof = {};
};

using SignFunction = std::function<Signature(std::span<const std::uint8_t>)>;

/// Returns the bytes of a whole message, with the signature by `sign`. Requires a channel of at
/// most 255 bytes and valid content.
[[nodiscard]] std::vector<std::uint8_t> encodeRelay(std::string_view channel, const RelayHead& head,
                                                    const RelayContent& content,
                                                    const SignFunction& sign);
/// Returns the head of a whole message. Returns an error for other bytes, for a message of another
/// channel, and for a term that is more than kMostTermLead ahead of `utc`, the time of arrival.
[[nodiscard]] Result<RelayHead, WireError> readRelayHead(std::span<const std::uint8_t> whole,
                                                         std::string_view channel,
                                                         std::chrono::system_clock::time_point utc);
/// Returns whether the owner of `key` has signed the whole message.
[[nodiscard]] bool verifyRelay(std::span<const std::uint8_t> whole, const VerifyingKey& key);
/// Returns the content of a whole message. It does not verify the signature. Returns an error for
/// invalid content. It does not decode frames and pictures. Requires readRelayHead() to succeed.
[[nodiscard]] Result<RelayContent, WireError> decodeRelay(std::span<const std::uint8_t> whole);

/// Returns the pieces of a whole message, each of at most `most_bytes`. Returns none if it needs
/// more than kMostRelayPieces.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> splitRelay(std::span<const std::uint8_t> whole,
                                                                std::uint64_t number,
                                                                std::size_t most_bytes);

/// Joins the pieces of messages that arrive in order. It stores at most one message. A piece that
/// came before changes nothing, and a message of one piece leaves the stored message alone.
class RelayJoiner {
 public:
  /// Returns whether a message with this first piece counts. The argument is the piece's content.
  using MayBegin = std::function<bool(std::span<const std::uint8_t>)>;

  /// `may_begin`: add() ignores the first piece of several if this function returns false. Null:
  /// each first piece begins a message. Thread of `may_begin`: that of add().
  explicit RelayJoiner(MayBegin may_begin = nullptr) : may_begin_(std::move(may_begin)) {}
  /// Adds a piece. Returns the whole message if the piece completes it, else nullopt. Returns an
  /// error if the bytes are no piece, or if a piece before it is missing, or if the message is too
  /// large.
  [[nodiscard]] Result<std::optional<std::vector<std::uint8_t>>, WireError> add(
      std::span<const std::uint8_t> piece);

 private:
  MayBegin may_begin_;
  std::uint64_t number_ = 0;  // of the stored message, or of the last one
  std::size_t pieces_ = 0;    // of the stored message; 0: there is none
  std::size_t next_ = 0;
  std::vector<std::uint8_t> whole_;
};

[[nodiscard]] std::vector<std::uint8_t> encodeRelayPing(const RelayPing& ping);
/// Returns the ping in `bytes`. Returns an error for other bytes, and for another version of the
/// protocol.
[[nodiscard]] Result<RelayPing, WireError> decodeRelayPing(std::span<const std::uint8_t> bytes);

}  // namespace hapticast
