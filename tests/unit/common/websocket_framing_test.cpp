// SPDX-License-Identifier: MIT
#include "common/transport/websocket_framing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "common/transport/http_responder.hpp"
#include "tests/support/websocket_frames.hpp"

namespace hapticast {
namespace {

using testing::maskedFrame;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kContinue = 0x00, kBinary = 0x02, kFinal = 0x80;
constexpr std::uint8_t kClose = 0x88, kPing = 0x89, kPong = 0x8A;

Bytes toBytes(const std::string& text) { return {text.begin(), text.end()}; }

Bytes prefixOf(WebSocketFraming& framing, std::size_t payload) {
  FramePrefix prefix;
  framing.writePrefix(payload, prefix);
  return {prefix.view().begin(), prefix.view().end()};
}

Bytes farewellOf(const WebSocketFraming& framing) {
  const FramePrefix farewell = framing.makeFarewell();
  return {farewell.view().begin(), farewell.view().end()};
}

/// What the bytes of a client hold: all messages, and the error at the end.
struct Outcome {
  std::vector<Bytes> messages;
  std::optional<ErrorCode> error;
  std::string why;
  bool ended = false;
  Bytes farewell;
  bool operator==(const Outcome&) const = default;
};

template <class NextSize>
Outcome read(const Bytes& stream, NextSize nextSize, std::size_t limit = kMaxSmallMessageBytes) {
  WebSocketFraming framing(limit);
  Outcome outcome;
  for (std::size_t at = 0; at < stream.size() && !outcome.error;) {
    const std::size_t size = std::min<std::size_t>(nextSize(), stream.size() - at);
    framing.feed(std::span(stream).subspan(at, size));
    at += size;
    for (;;) {
      const auto next = framing.next();
      if (!next.ok()) {
        outcome.error = next.error().code;
        outcome.why = next.error().message;
        EXPECT_EQ(framing.next().ok(), false) << "an error stays";
        break;
      }
      if (!next.value()) break;
      outcome.messages.emplace_back(next.value()->begin(), next.value()->end());
    }
  }
  outcome.ended = framing.ended();
  outcome.farewell = farewellOf(framing);
  return outcome;
}

Outcome readWhole(const Bytes& stream, std::size_t limit = kMaxSmallMessageBytes) {
  return read(
      stream, [&] { return stream.size(); }, limit);
}

Outcome readBytes(const Bytes& stream, std::size_t limit = kMaxSmallMessageBytes) {
  return read(
      stream, [] { return std::size_t{1}; }, limit);
}

Bytes join(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& each : parts) all.insert(all.end(), each.begin(), each.end());
  return all;
}

TEST(WebSocketFraming, HasTheBytesOfTheExamplesOfRfc6455) {
  // Section 5.7, with the binary opcode in place of that of a text.
  const Bytes masked{0x82, 0x85, 0x37, 0xfa, 0x21, 0x3d, 0x7f, 0x9f, 0x4d, 0x51, 0x58};
  EXPECT_EQ(maskedFrame(0x82, toBytes("Hello"), {0x37, 0xfa, 0x21, 0x3d}), masked);
  EXPECT_EQ(readWhole(masked).messages, (std::vector<Bytes>{toBytes("Hello")}));
  WebSocketFraming framing(100);
  EXPECT_EQ(prefixOf(framing, 5), (Bytes{0x82, 0x05}));
  EXPECT_EQ(prefixOf(framing, 256), (Bytes{0x82, 0x7E, 0x01, 0x00}));
  EXPECT_EQ(prefixOf(framing, 65536),
            (Bytes{0x82, 0x7F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00}));
  const Bytes ping{0x89, 0x85, 0x37, 0xfa, 0x21, 0x3d, 0x7f, 0x9f, 0x4d, 0x51, 0x58};
  framing.feed(ping);
  EXPECT_TRUE(framing.next().ok());
  EXPECT_EQ(prefixOf(framing, 5), join({{0x8A, 0x05}, toBytes("Hello"), {0x82, 0x05}}));
  EXPECT_EQ(farewellOf(framing), (Bytes{0x88, 0x02, 0x03, 0xE8}));
}

TEST(WebSocketFraming, UsesTheShortestLength) {
  WebSocketFraming framing(100);
  EXPECT_EQ(prefixOf(framing, 125).size(), 2U);
  EXPECT_EQ(prefixOf(framing, 126).size(), 4U);
  EXPECT_EQ(prefixOf(framing, 65535), (Bytes{0x82, 0x7E, 0xFF, 0xFF}));
  EXPECT_EQ(prefixOf(framing, kMaxMessageBytes).size(), 10U);
}

TEST(WebSocketFraming, GivesTheSameMessagesHoweverTheyAreCut) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Bytes> sent, frames;
    for (int i = 0; i < 20; ++i) {
      Bytes message(1 + random() % (i % 7 == 0 ? 70000 : 300));
      for (std::uint8_t& each : message) each = static_cast<std::uint8_t>(random());
      message.resize(std::min(message.size(), kMaxSmallMessageBytes));
      const std::size_t pieces = 1 + random() % 4;
      for (std::size_t at = 0, piece = 0; piece < pieces; ++piece) {
        const bool last = piece + 1 == pieces;
        const std::size_t size = last ? message.size() - at : random() % (message.size() - at + 1);
        const auto head = static_cast<std::uint8_t>((piece == 0 ? kBinary : kContinue) |
                                                    (last ? kFinal : std::uint8_t{0}));
        frames.push_back(maskedFrame(
            head,
            {message.begin() + static_cast<std::ptrdiff_t>(at),
             message.begin() + static_cast<std::ptrdiff_t>(at + size)},
            {static_cast<std::uint8_t>(random()), 7, static_cast<std::uint8_t>(random()), 0}));
        at += size;
        if (random() % 3 == 0) frames.push_back(maskedFrame(random() % 2 ? kPing : kPong, {1, 2}));
      }
      sent.push_back(std::move(message));
    }
    const Bytes stream = join(frames);
    const Outcome outcome = read(stream, [&] { return 1 + random() % 3000; });
    ASSERT_EQ(outcome.error, std::nullopt) << outcome.why;
    ASSERT_EQ(outcome.messages, sent);
  }
}

TEST(WebSocketFraming, RefusesBytesThatAreNoFrameOfAViewer) {
  const auto long_head = [](std::uint8_t head, std::uint64_t length) {
    Bytes bytes{head, 0xFF};
    for (int shift = 56; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(length >> static_cast<unsigned>(shift)));
    bytes.insert(bytes.end(), 4, 0);
    return bytes;
  };
  const std::vector<std::pair<Bytes, std::string>> wrong{
      {long_head(0x82, std::uint64_t{1} << 63U), "a length of 2^63 or more"},
      {long_head(0x82, 0xFFFF), "a length in more bytes than it needs"},
      {{0x82, 0xFE, 0x00, 0x7D, 0, 0, 0, 0}, "a length in more bytes than it needs"},
      {{0x82, 0x01, 0x00}, "a frame of a client without a mask"},
      {maskedFrame(0x81, {1}), "a text message; this stream has binary messages"},
      {maskedFrame(0xC2, {1}), "a reserved bit, but no extension is in use"},
      {maskedFrame(0xA2, {1}), "a reserved bit, but no extension is in use"},
      {maskedFrame(0x92, {1}), "a reserved bit, but no extension is in use"},
      {maskedFrame(0x83, {1}), "a frame with an unknown opcode"},
      {maskedFrame(0x8B, {1}), "a frame with an unknown opcode"},
      {maskedFrame(0x09, {1}), "a control frame in fragments or above 125 bytes"},
      {maskedFrame(0x89, Bytes(126)), "a control frame in fragments or above 125 bytes"},
      {maskedFrame(0x80, {1}), "a continuation without a begin"},
      {maskedFrame(0x00, {1}), "a continuation without a begin"},
      {join({maskedFrame(0x02, {1}), maskedFrame(0x82, {1})}),
       "a second message inside the fragments of the first"},
      {maskedFrame(0x82, {}), "a message of length 0"},
      {join({maskedFrame(0x02, {}), maskedFrame(0x80, {})}), "a message of length 0"},
      {maskedFrame(0x88, {1}), "a close frame of one byte"},
  };
  for (const auto& [bytes, why] : wrong) {
    const Outcome outcome = readWhole(bytes);
    EXPECT_EQ(outcome.why, why);
    EXPECT_EQ(outcome.error, ErrorCode::kMalformed) << why;
    EXPECT_EQ(outcome.farewell, (Bytes{0x88, 0x02, 0x03, 0xEA})) << why << ": 1002";
    EXPECT_EQ(readBytes(bytes), outcome) << why;
  }
}

TEST(WebSocketFraming, RefusesALongMessageBeforeItArrives) {
  const Bytes at_limit = maskedFrame(0x82, Bytes(200, 1)), above = maskedFrame(0x82, Bytes(201, 1));
  EXPECT_EQ(readWhole(at_limit, 200).messages.size(), 1U);
  const Bytes header(above.begin(), above.begin() + 8);
  const Outcome outcome = readWhole(header, 200);
  EXPECT_EQ(outcome.error, ErrorCode::kTooLarge);
  EXPECT_EQ(outcome.farewell, (Bytes{0x88, 0x02, 0x03, 0xF1})) << "1009";
  const Bytes fragments = join({maskedFrame(0x02, Bytes(150, 1)), maskedFrame(0x80, Bytes(51, 1))});
  EXPECT_EQ(readWhole(fragments, 200).error, ErrorCode::kTooLarge);
  EXPECT_EQ(
      readWhole({0x82, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0}).error,
      ErrorCode::kTooLarge);
}

TEST(WebSocketFraming, RefusesAFloodOfFragments) {
  Bytes flood = maskedFrame(0x02, {1});
  for (std::size_t i = 1; i < WebSocketFraming::kMostFragments; ++i) {
    const Bytes next = maskedFrame(0x00, i % 2 == 0 ? Bytes{1} : Bytes{});
    flood.insert(flood.end(), next.begin(), next.end());
  }
  EXPECT_EQ(readWhole(flood).error, std::nullopt);
  const Bytes last = maskedFrame(0x80, {1});
  flood.insert(flood.end(), last.begin(), last.end());
  EXPECT_EQ(readWhole(flood).why, "a message in too many fragments");
}

TEST(WebSocketFraming, AnswersOnlyTheNewestPing) {
  WebSocketFraming framing(100);
  for (int i = 0; i < 1000; ++i) framing.feed(maskedFrame(kPing, toBytes(std::to_string(i))));
  const auto next = framing.next();
  EXPECT_TRUE(next.ok() && !next.value());
  EXPECT_EQ(prefixOf(framing, 1), join({{0x8A, 0x03}, toBytes("999"), {0x82, 0x01}}));
  EXPECT_EQ(prefixOf(framing, 1), (Bytes{0x82, 0x01})) << "once";
  framing.feed(maskedFrame(kPing, Bytes(125, 7)));
  EXPECT_TRUE(framing.next().ok());
  EXPECT_EQ(prefixOf(framing, 65536).size(), FramePrefix::kMostBytes);
  framing.feed(maskedFrame(kPing, {}));
  EXPECT_TRUE(framing.next().ok());
  EXPECT_EQ(prefixOf(framing, 1), (Bytes{0x8A, 0x00, 0x82, 0x01}));
}

TEST(WebSocketFraming, EndsWithTheCloseOfTheClient) {
  const Bytes stream = join({maskedFrame(0x82, {1}), maskedFrame(kClose, {0x03, 0xE9}),
                             maskedFrame(0x82, {2}), maskedFrame(0x81, {3})});
  for (const Outcome& outcome : {readWhole(stream), readBytes(stream)}) {
    EXPECT_EQ(outcome.messages, (std::vector<Bytes>{{1}}));
    EXPECT_EQ(outcome.error, std::nullopt);
    EXPECT_TRUE(outcome.ended);
    EXPECT_EQ(outcome.farewell, (Bytes{0x88, 0x02, 0x03, 0xE8}));
  }
  EXPECT_TRUE(readWhole(maskedFrame(kClose, {})).ended);
}

TEST(HttpHead, EndsAtTheEmptyLineHoweverItIsCut) {
  const std::string head = "GET / HTTP/1.1\r\nHost: a\r\n\r\n", rest = "\x82\x01\x02";
  const Bytes stream = toBytes(head + rest);
  for (std::size_t cut = 1; cut < stream.size(); ++cut) {
    HttpHead collected;
    const bool first = collected.add(std::span(stream).first(cut));
    EXPECT_EQ(first, cut >= head.size()) << cut;
    if (!first) {
      EXPECT_TRUE(collected.add(std::span(stream).subspan(cut)));
    }
    EXPECT_EQ(collected.text(), head) << cut;
    const Bytes behind(collected.rest().begin(), collected.rest().end());
    EXPECT_EQ(behind, toBytes(first ? rest.substr(0, cut - head.size()) : rest)) << cut;
  }
}

TEST(HttpHead, EndsAtItsLimit) {
  HttpHead head;
  for (std::size_t i = 0; i < HttpHead::kMostBytes; ++i) ASSERT_FALSE(head.add(toBytes("a")));
  EXPECT_TRUE(head.add(toBytes("a")));
  EXPECT_EQ(head.text().size(), HttpHead::kMostBytes + 1);
}

}  // namespace
}  // namespace hapticast
