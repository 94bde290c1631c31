// SPDX-License-Identifier: MIT
#include "client/net/message_receiver.hpp"

#include <string>
#include <utility>

#include "common/protocol/signed_frame.hpp"

namespace hapticast::client {

Result<Message, WireError> MessageReceiver::receive(std::span<const std::uint8_t> bytes,
                                                    LocalTime now) {
  auto message = decode(bytes);
  auto error = message.ok() ? process(message.value(), bytes, now) : message.error();
  if (!error) return message;
  disconnect(now);
  return std::move(*error);
}

void MessageReceiver::disconnect(LocalTime now) {
  welcomed_ = false;
  receiver_.disconnected(now);
}

std::optional<WireError> MessageReceiver::onWelcome(const Welcome& welcome, LocalTime now) {
  if (welcome.protocol_version != kProtocolVersion)
    return WireError{ErrorCode::kVersion, "the messages are of protocol version " +
                                              std::to_string(welcome.protocol_version) +
                                              ", not of " + std::to_string(kProtocolVersion)};
  auto refusal = origin_.refuse(welcome.verifying_key);
  untrusted_ = refusal.has_value();
  if (refusal) return WireError{ErrorCode::kUnexpected, std::move(*refusal)};
  if (!welcomed_) {
    welcomes_ = makeWelcomeLimiter();
  } else if (welcomes_.allow(now)) {
    receiver_.disconnected(now);
  } else {
    return WireError{ErrorCode::kUnexpected, "the server changes its origin too often"};
  }
  key_.reset();
  if (welcome.verifying_key) {
    auto key = VerifyingKey::from(*welcome.verifying_key);
    if (!key.ok()) return WireError{ErrorCode::kMalformed, "the server's key is not valid"};
    key_ = std::move(key).value();
  }
  stream_ = welcome.stream;
  welcomed_ = true;
  receiver_.connected(welcome.description, now);
  return std::nullopt;
}

std::optional<WireError> MessageReceiver::process(Message& message,
                                                  std::span<const std::uint8_t> bytes,
                                                  LocalTime now) {
  if (auto* const error = std::get_if<WireError>(&message)) return std::move(*error);
  if (const auto* const welcome = std::get_if<Welcome>(&message)) return onWelcome(*welcome, now);
  if (!welcomed_) return WireError{ErrorCode::kUnexpected, "the first message is not a welcome"};
  if (auto* const frame = std::get_if<CodedFrame>(&message)) {
    if (key_ && !verifyFrame(bytes, stream_, *key_))
      return WireError{ErrorCode::kMalformed, "a frame has no valid signature"};
    receiver_.frame(std::move(*frame), now);
  } else if (const auto* const pong = std::get_if<Pong>(&message)) {
    receiver_.pong(*pong, now);
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    receiver_.describe(*description, now);
  }
  return std::nullopt;  // the others change no force
}

}  // namespace hapticast::client
