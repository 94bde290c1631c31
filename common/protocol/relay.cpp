// SPDX-License-Identifier: MIT
#include "common/protocol/relay.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/protocol/check.hpp"
#include "common/protocol/scan.hpp"
#include "common/transport/datagram.hpp"
#include "relay.pb.h"

namespace hapticast {

namespace {

using RelayBytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kRelayMagic[] = {'h', 'a', 'p', 't', 'i', 'c', 'R', '3'};
constexpr std::uint8_t kPieceMagic[] = {'H', 'C', 'R', '3'};
constexpr std::size_t kNumbersBytes = 3 * sizeof(std::uint64_t);
// Numbers of RelayContent.frame and RelayFrame.datagrams.
constexpr std::uint32_t kRelayFrameField = 2;
constexpr std::uint32_t kDatagramsField = 6;

template <class Number>
void append(RelayBytes& bytes, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i)
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i)));
}

std::uint64_t readNumber(std::span<const std::uint8_t> bytes, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < size; ++i) number |= std::uint64_t{bytes[i]} << (8 * i);
  return number;
}

template <class Bytes>
void setBytes(std::string& to, const Bytes& from) {
  to.assign(from.begin(), from.end());
}

std::int64_t toNs(MediaTime time) { return time.time_since_epoch().count(); }

void writeRelay(const RelayState& from, proto::RelayContent& content) {
  auto& to = *content.mutable_state();
  to.set_protocol_version(kProtocolVersion);
  setBytes(*to.mutable_description(), encode(from.description));
  to.set_stream(from.stream);
  setBytes(*to.mutable_verifying_key(), from.verifying_key);
  setBytes(*to.mutable_probe(), from.probe);
  to.set_sealed(from.sealed);
  if (from.datagram_key) setBytes(*to.mutable_datagram_key(), encode(*from.datagram_key));
}

void writeRelay(const RelayFrame& from, proto::RelayContent& content) {
  auto& to = *content.mutable_frame();
  to.set_epoch(from.epoch);
  to.set_id(from.id);
  to.set_media_time_ns(toNs(from.media_time));
  setBytes(*to.mutable_delta(), *from.delta);
  if (from.key_frame) setBytes(*to.mutable_key_frame(), *from.key_frame);
  if (from.datagrams) {
    for (const RelayBytes& body : *from.datagrams) setBytes(*to.add_datagrams(), body);
  }
  to.set_too_many_datagrams(from.too_many_datagrams);
}

void writeRelay(const RelayPicture& from, proto::RelayContent& content) {
  auto& to = *content.mutable_picture();
  to.set_id(from.id);
  to.set_media_time_ns(toNs(from.media_time));
  setBytes(*to.mutable_message(), *from.message);
}

void writeRelay(const RelayPong& from, proto::RelayContent& content) {
  auto& to = *content.mutable_pong();
  to.set_t0_ns(from.t0.time_since_epoch().count());
  to.set_t1_ns(toNs(from.t1));
  to.set_t2_ns(toNs(from.t2));
}

SharedBytes shareMessage(const std::string& from, Check& check) {
  check.require(!from.empty(), "a relayed message is empty");
  check.bound(from.size(), kMaxMessageBytes, "a relayed message is larger than 8 MiB");
  if (check.error()) return nullptr;
  return std::make_shared<const RelayBytes>(from.begin(), from.end());
}

/// Returns the message of the type `Kind` in `bytes`; nullopt for other bytes.
template <class Kind>
std::optional<Kind> readMessage(const std::string& bytes) {
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
  auto message = decode(std::span(begin, bytes.size()));
  if (!message.ok() || !std::holds_alternative<Kind>(message.value())) return std::nullopt;
  return std::get<Kind>(std::move(message).value());
}

RelayContent readRelay(const proto::RelayState& from, Check& check) {
  RelayState to;
  check.require(from.protocol_version() == kProtocolVersion,
                "the origin has another version of the protocol");
  check.require(from.verifying_key().size() == kKeyBytes, "a verifying key is not 32 bytes");
  check.require(from.probe().size() == kMostDatagramBytes - kTokenBytes,
                "a probe does not have the size of the largest datagram");
  if (check.error()) return to;
  auto description = readMessage<StreamDescription>(from.description());
  check.require(description.has_value(), "a state without a description");
  if (!description) return to;
  to.description = std::move(*description);
  to.sealed = from.sealed();
  if (!from.datagram_key().empty()) {
    to.datagram_key = readMessage<DatagramKey>(from.datagram_key());
    check.require(to.sealed && to.datagram_key.has_value(),
                  "a state with an invalid key of datagrams");
  }
  to.stream = from.stream();
  std::copy(from.verifying_key().begin(), from.verifying_key().end(), to.verifying_key.begin());
  to.probe.assign(from.probe().begin(), from.probe().end());
  return to;
}

RelayContent readRelay(const proto::RelayFrame& from, Check& check) {
  RelayFrame to;
  to.epoch = from.epoch();
  to.id = from.id();
  to.media_time = MediaTime(check.time(from.media_time_ns()));
  to.delta = shareMessage(from.delta(), check);
  if (!from.key_frame().empty()) to.key_frame = shareMessage(from.key_frame(), check);
  to.too_many_datagrams = from.too_many_datagrams();
  if (check.error() || from.datagrams().empty()) return to;
  auto bodies = std::make_shared<std::vector<RelayBytes>>();
  bodies->reserve(static_cast<std::size_t>(from.datagrams_size()));
  for (const std::string& body : from.datagrams()) {
    check.require(body.size() >= kDatagramHeaderBytes - kTokenBytes + kSignatureBytes &&
                      body.size() <= kMostDatagramBytes - kTokenBytes,
                  "a datagram has a wrong size");
    bodies->emplace_back(body.begin(), body.end());
  }
  to.datagrams = std::move(bodies);
  return to;
}

RelayContent readRelay(const proto::RelayPicture& from, Check& check) {
  return RelayPicture{from.id(), MediaTime(check.time(from.media_time_ns())),
                      shareMessage(from.message(), check)};
}

RelayContent readRelay(const proto::RelayPong& from, Check& check) {
  return RelayPong{LocalTime(check.time(from.t0_ns())), MediaTime(check.time(from.t1_ns())),
                   MediaTime(check.time(from.t2_ns()))};
}

RelayContent readRelayContent(const proto::RelayContent& from, Check& check) {
  switch (from.content_case()) {
    case proto::RelayContent::kState:
      return readRelay(from.state(), check);
    case proto::RelayContent::kFrame:
      return readRelay(from.frame(), check);
    case proto::RelayContent::kPicture:
      return readRelay(from.picture(), check);
    case proto::RelayContent::kPong:
      return readRelay(from.pong(), check);
    case proto::RelayContent::CONTENT_NOT_SET:
      break;
  }
  check.require(false, "a relayed message without content");
  return RelayPong{};
}

/// Counts the datagrams before the parser allocates memory for them.
void boundDatagrams(std::span<const std::uint8_t> content, Check& check) {
  const auto frames = submessages(content, kRelayFrameField, 1);
  check.require(frames.has_value(), "more than one frame in a relayed message");
  if (!frames || frames->empty()) return;
  if (!submessages(frames->front(), kDatagramsField, kMostParts))
    check.bound(kMostParts + 1, kMostParts, "too many datagrams in a frame");
}

std::size_t contentBegin(std::span<const std::uint8_t> whole) {
  return std::size(kRelayMagic) + 1 + whole[std::size(kRelayMagic)] + kNumbersBytes;
}

/// Describes the loss of the message whose first bytes are `begin`, with its sender.
std::string describeLoss(std::span<const std::uint8_t> begin, std::uint64_t number) {
  std::string text = "pieces of the message " + std::to_string(number) + " are missing";
  const std::size_t magic = std::size(kRelayMagic);
  if (begin.size() <= magic || begin.size() < contentBegin(begin)) return text;
  const auto origin = begin.subspan(contentBegin(begin) - kNumbersBytes + sizeof(RelayHead::term));
  return text + " (origin " + std::to_string(readNumber(origin, sizeof(RelayHead::origin))) + ")";
}

}  // namespace

std::vector<std::uint8_t> encodeRelay(std::string_view channel, const RelayHead& head,
                                      const RelayContent& content, const SignFunction& sign) {
  proto::RelayContent message;
  std::visit([&](const auto& each) { writeRelay(each, message); }, content);
  const std::size_t size = message.ByteSizeLong();
  RelayBytes whole;
  whole.reserve(std::size(kRelayMagic) + 1 + channel.size() + kNumbersBytes + size +
                kSignatureBytes);
  whole.insert(whole.end(), std::begin(kRelayMagic), std::end(kRelayMagic));
  whole.push_back(static_cast<std::uint8_t>(channel.size()));
  whole.insert(whole.end(), channel.begin(), channel.end());
  append(whole, head.term);
  append(whole, head.origin);
  append(whole, head.number);
  const std::size_t begin = whole.size();
  whole.resize(begin + size);
  message.SerializeWithCachedSizesToArray(whole.data() + begin);
  const Signature signature = sign(whole);
  whole.insert(whole.end(), signature.begin(), signature.end());
  return whole;
}

Result<RelayHead, WireError> readRelayHead(std::span<const std::uint8_t> whole,
                                           std::string_view channel,
                                           std::chrono::system_clock::time_point utc) {
  const std::size_t least =
      std::size(kRelayMagic) + 1 + channel.size() + kNumbersBytes + kSignatureBytes;
  if (whole.size() < std::size(kRelayMagic) + 1 ||
      !std::equal(std::begin(kRelayMagic), std::end(kRelayMagic), whole.begin()))
    return malformed("bytes that are not a relayed message");
  if (whole.size() < least || whole[std::size(kRelayMagic)] != channel.size() ||
      !std::equal(channel.begin(), channel.end(), whole.begin() + std::size(kRelayMagic) + 1))
    return malformed("a message of another channel");
  const auto numbers = whole.subspan(contentBegin(whole) - kNumbersBytes);
  const RelayHead head{readNumber(numbers, 8), readNumber(numbers.subspan(8), 8),
                       readNumber(numbers.subspan(16), 8)};
  const auto latest =
      std::chrono::duration_cast<std::chrono::seconds>((utc + kMostTermLead).time_since_epoch());
  if (latest.count() < 0 || head.term > static_cast<std::uint64_t>(latest.count()))
    return malformed("a term is more than a day ahead of this machine's clock; set both clocks");
  return head;
}

bool verifyRelay(std::span<const std::uint8_t> whole, const VerifyingKey& key) {
  if (whole.size() < kSignatureBytes) return false;
  const std::size_t size = whole.size() - kSignatureBytes;
  return key.verify(whole.first(size), whole.subspan(size));
}

Result<RelayContent, WireError> decodeRelay(std::span<const std::uint8_t> whole) {
  const std::size_t begin = contentBegin(whole);
  const auto content = whole.subspan(begin, whole.size() - begin - kSignatureBytes);
  Check check;
  check.bound(content.size(), kMostRelayBytes, "a relayed message is larger than 32 MiB");
  if (!check.error()) boundDatagrams(content, check);
  proto::RelayContent parsed;
  if (!check.error()) {
    check.require(parsed.ParseFromArray(content.data(), static_cast<int>(content.size())),
                  "bytes that are not a relayed message");
  }
  if (check.error()) return *check.error();
  RelayContent read = readRelayContent(parsed, check);
  if (check.error()) return *check.error();
  return read;
}

std::vector<std::vector<std::uint8_t>> splitRelay(std::span<const std::uint8_t> whole,
                                                  std::uint64_t number, std::size_t most_bytes) {
  if (most_bytes <= kRelayPieceHeadBytes) return {};
  const std::size_t room = most_bytes - kRelayPieceHeadBytes;
  const std::size_t count = (whole.size() + room - 1) / room;
  if (count == 0 || count > kMostRelayPieces) return {};
  std::vector<RelayBytes> pieces(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto part = whole.subspan(i * room, std::min(room, whole.size() - i * room));
    RelayBytes& piece = pieces[i];
    piece.reserve(kRelayPieceHeadBytes + part.size());
    piece.insert(piece.end(), std::begin(kPieceMagic), std::end(kPieceMagic));
    append(piece, static_cast<std::uint16_t>(i));
    append(piece, static_cast<std::uint16_t>(count));
    append(piece, number);
    piece.insert(piece.end(), part.begin(), part.end());
  }
  return pieces;
}

Result<std::optional<std::vector<std::uint8_t>>, WireError> RelayJoiner::add(
    std::span<const std::uint8_t> piece) {
  if (piece.size() <= kRelayPieceHeadBytes ||
      !std::equal(std::begin(kPieceMagic), std::end(kPieceMagic), piece.begin()))
    return malformed("bytes that are not a piece of a relayed message");
  const std::uint64_t index = readNumber(piece.subspan(4), 2);
  const std::uint64_t count = readNumber(piece.subspan(6), 2);
  const std::uint64_t number = readNumber(piece.subspan(8), 8);
  if (count == 0 || count > kMostRelayPieces || index >= count)
    return malformed("the number of a piece is out of range");
  const auto content = piece.subspan(kRelayPieceHeadBytes);
  if (count == 1) return std::optional(RelayBytes(content.begin(), content.end()));
  const bool same = number == number_ && count == pieces_;
  if (index == 0) {
    const bool again = same && content.size() <= whole_.size() &&
                       std::equal(content.begin(), content.end(), whole_.begin());
    if (again || (may_begin_ && !may_begin_(content))) return std::optional<RelayBytes>();
    whole_.clear();
    number_ = number;
    pieces_ = count;
  } else if (number < number_ || (number == number_ && index < next_)) {
    return std::optional<RelayBytes>();  // it came before
  } else if (!same || index != next_) {
    const std::span<const std::uint8_t> begin(whole_.data(), same ? whole_.size() : 0);
    return WireError{ErrorCode::kMalformed, describeLoss(begin, number)};
  }
  if (whole_.size() + content.size() > kMostRelayBytes) {
    pieces_ = 0;
    return WireError{ErrorCode::kTooLarge, "a relayed message is larger than 32 MiB"};
  }
  whole_.insert(whole_.end(), content.begin(), content.end());
  next_ = index + 1;
  if (next_ != count) return std::optional<RelayBytes>();
  pieces_ = 0;
  return std::optional(std::exchange(whole_, {}));
}

std::vector<std::uint8_t> encodeRelayPing(const RelayPing& ping) {
  proto::RelayPing to;
  to.set_protocol_version(kProtocolVersion);
  to.set_t0_ns(ping.t0.time_since_epoch().count());
  to.set_wants_pictures(ping.wants_pictures);
  to.set_wants_datagrams(ping.wants_datagrams);
  to.set_proof(ping.proof.data(), ping.proof.size());
  RelayBytes bytes(to.ByteSizeLong());
  to.SerializeWithCachedSizesToArray(bytes.data());
  return bytes;
}

Result<RelayPing, WireError> decodeRelayPing(std::span<const std::uint8_t> bytes) {
  proto::RelayPing from;
  if (bytes.size() > kMaxSmallMessageBytes ||
      !from.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return malformed("bytes that are not a ping");
  Check check;
  check.require(from.protocol_version() == kProtocolVersion,
                "an edge has another version of the protocol");
  RelayPing ping{LocalTime(check.time(from.t0_ns())),
                 from.wants_pictures(),
                 from.wants_datagrams(),
                 {from.proof().begin(), from.proof().end()}};
  if (check.error()) return *check.error();
  return ping;
}

}  // namespace hapticast
