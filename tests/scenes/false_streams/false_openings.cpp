// SPDX-License-Identifier: MIT
#include "tests/scenes/false_streams/false_openings.hpp"

#include <string_view>
#include <utility>

#include "common/protocol/messages.hpp"
#include "common/protocol/signed_frame.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_messages.hpp"

namespace hapticast::testing {

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes makeWelcome(std::uint32_t version = kProtocolVersion) {
  return encode(Welcome{version, 1, 0, {}});
}

Bytes makeSignedWelcome() {
  Welcome welcome{kProtocolVersion, 1, 0, {}};
  welcome.stream = 5;
  welcome.verifying_key = goldenSigningKey().verifyingKey();
  return encode(welcome);
}

CodedFrame makeFrame() { return coded(goldenFrame()); }

Bytes signFrame(SigningKey&& key, std::uint32_t stream) {
  return *encodeSigned(makeFrame(), stream, key);
}

Bytes cut(Bytes bytes, std::size_t size) {
  bytes.resize(size);
  return bytes;
}

/// Every kind of message but a welcome and an error, first and after the welcome.
void addKinds(std::vector<FalseOpening>& to) {
  constexpr const char* kFirst = "the first message is not a welcome";
  constexpr const char* kOfClients = "the server sent a message that only clients send";
  for (const auto& [name, message] : goldenMessages()) {
    if (std::holds_alternative<Welcome>(message) || std::holds_alternative<WireError>(message))
      continue;
    to.push_back({name + " first", {encode(message)}, kFirst});
  }
  const std::vector<Message> of_clients = {Hello{}, Ping{}, ReceiverReport{}, Delivery{}};
  for (const Message& message : of_clients)
    to.push_back({"of a client, kind " + std::to_string(message.index()),
                  {makeWelcome(), encode(message)},
                  kOfClients});
  to.push_back({"an answer to nothing",
                {makeWelcome(), encode(Control{})},
                "the server answers a request that the client did not send"});
  to.push_back({"a key of no datagrams",
                {makeWelcome(), encode(goldenKey())},
                "a key of datagrams for a stream without them"});
}

void addErrors(std::vector<FalseOpening>& to) {
  for (int code = 1; code <= 9; ++code) {
    const WireError error{static_cast<ErrorCode>(code), "for the reason " + std::to_string(code)};
    to.push_back({"error " + std::to_string(code), {encode(error)}, error.message});
  }
  to.push_back({"an error after the welcome",
                {makeWelcome(), encode(WireError{ErrorCode::kShuttingDown, "it ends"})},
                "it ends"});
}

void addWelcomes(std::vector<FalseOpening>& to) {
  for (const std::uint32_t version : {1U, 2U, 4U, 1'000'000U})
    to.push_back({"version " + std::to_string(version),
                  {makeWelcome(version)},
                  "the server has protocol version " + std::to_string(version)});
  Welcome with_key{kProtocolVersion, 1, 0, {}};
  with_key.datagram_key = goldenKey();
  with_key.verifying_key = goldenSigningKey().verifyingKey();
  to.push_back({"a key of datagrams in plain text",
                {encode(with_key)},
                "a key of datagrams arrived without TLS",
                true});
  to.push_back({"many welcomes", std::vector<Bytes>(5, makeWelcome()),
                "the server changes its origin too often"});
  to.push_back({"a cut welcome", {cut(encode(goldenWelcome()), 40)}, ""});
  to.push_back({"a long first message",
                {cut(makeWelcome(), kMaxSmallMessageBytes + 1)},
                "65537 bytes, at most 65536 are allowed here"});
}

void addSignatures(std::vector<FalseOpening>& to) {
  constexpr const char* kUnsigned = "a frame has no valid signature";
  Bytes changed = signFrame(goldenSigningKey(), 5);
  changed.back() ^= 1U;
  to.push_back({"no signature", {makeSignedWelcome(), encode(makeFrame())}, kUnsigned});
  to.push_back({"a changed byte", {makeSignedWelcome(), std::move(changed)}, ""});
  to.push_back(
      {"of another stream", {makeSignedWelcome(), signFrame(goldenSigningKey(), 6)}, kUnsigned});
  to.push_back(
      {"by another key", {makeSignedWelcome(), signFrame(SigningKey(KeyBytes{99}), 5)}, kUnsigned});
}

void addNoise(std::vector<FalseOpening>& to) {
  to.push_back({"one byte", {Bytes{7}}, ""});
  to.push_back({"ones", {Bytes(100, 0xFF)}, ""});
  to.push_back({"zeros", {Bytes(100, 0)}, ""});
  const std::string_view page = "HTTP/1.1 400 Bad Request\r\n\r\n";
  to.push_back({"a page", {Bytes(page.begin(), page.end())}, ""});
  to.push_back({"noise after the welcome", {makeWelcome(), Bytes(100, 0xFF)}, ""});
}

}  // namespace

std::vector<FalseOpening> listFalseOpenings() {
  std::vector<FalseOpening> all;
  addKinds(all);
  addErrors(all);
  addWelcomes(all);
  addSignatures(all);
  addNoise(all);
  return all;
}

}  // namespace hapticast::testing
