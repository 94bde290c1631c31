// SPDX-License-Identifier: MIT
#include "client/net/client_session.hpp"

#include <algorithm>
#include <utility>

#include "common/protocol/signed_frame.hpp"

namespace hapticast::client {

namespace {

constexpr std::size_t kMaxPingsOut = 64;  // older unanswered pings are dropped

WireError makeUnexpected(const char* what) { return {ErrorCode::kUnexpected, what}; }

/// Returns the key of `welcome`; nullopt if the server signs nothing.
Result<std::optional<VerifyingKey>, WireError> readKey(const Welcome& welcome) {
  if (!welcome.verifying_key) return std::optional<VerifyingKey>();
  auto key = VerifyingKey::from(*welcome.verifying_key);
  if (!key.ok()) return WireError{ErrorCode::kMalformed, "the server's key is not valid"};
  return std::optional<VerifyingKey>(std::move(key).value());
}

}  // namespace

ClientSession::ClientSession(SessionSettings settings, Receiver* receiver)
    : settings_(std::move(settings)),
      receiver_(receiver),
      wants_pictures_(settings_.wants_video),
      pause_(settings_.first_retry) {}

std::optional<SessionEnd> ClientSession::open(Protection protection, LocalTime now) {
  const bool is_protected =
      protection.encrypted || protection.of_this_machine || settings_.insecure;
  if (!settings_.access_token.empty() && !is_protected)
    return SessionEnd{
        .why = "the access token would travel unencrypted: use hapticasts://HOST, or --insecure",
        .untrusted = true};
  state_ = State();
  state_.is_open = true;
  state_.protection = protection;
  state_.deadline = now + settings_.connect_deadline;
  state_.overdue = "no welcome arrived; is it a hapticast server?";
  return std::nullopt;
}

std::size_t ClientSession::readLimit() const {
  return welcomed() ? kMaxMessageBytes : kMaxSmallMessageBytes;
}

Result<Message, SessionEnd> ClientSession::receive(std::span<const std::uint8_t> bytes,
                                                   LocalTime now) {
  if (bytes.size() > readLimit())
    return SessionEnd{.why = "a message of " + std::to_string(bytes.size()) + " bytes, at most " +
                             std::to_string(readLimit()) + " are allowed here",
                      .code = ErrorCode::kTooLarge};
  state_.received_bytes += bytes.size();
  state_.received_at = now;
  auto message = decode(bytes);
  auto error = message.ok() ? process(message.value(), bytes, now) : message.error();
  if (error)
    return SessionEnd{
        .why = std::move(error->message), .code = error->code, .untrusted = state_.untrusted};
  state_.deadline = now + settings_.silence_limit;
  state_.overdue = "the server stopped sending";
  if (state_.sends_receipts && state_.receipt_due == LocalTime::max())
    state_.receipt_due = std::max(now, state_.receipt_sent + settings_.receipt_interval);
  return std::move(message).value();
}

std::optional<WireError> ClientSession::process(Message& message,
                                                std::span<const std::uint8_t> bytes,
                                                LocalTime now) {
  if (auto* const error = std::get_if<WireError>(&message)) return std::move(*error);
  if (const auto* const welcome = std::get_if<Welcome>(&message)) return onWelcome(*welcome, now);
  if (!welcomed()) return makeUnexpected("the first message is not a welcome");
  if (auto* const frame = std::get_if<CodedFrame>(&message)) return onFrame(*frame, bytes, now);
  if (std::holds_alternative<PicturePart>(message)) return onPart(message);
  if (const auto* const pong = std::get_if<Pong>(&message)) {
    onPong(*pong, now);
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    onDescription(*description, now);
  } else if (std::holds_alternative<DatagramKey>(message)) {
    if (!state_.sealed_datagrams)
      return makeUnexpected("a key of datagrams for a stream without them");
  } else if (const auto* const control = std::get_if<Control>(&message)) {
    const bool is_act = control->at.has_value();  // of another operator
    if (!(is_act ? settings_.wants_acts : state_.has_requested))
      return makeUnexpected("the server answers a request that the client did not send");
  } else if (!std::holds_alternative<VideoFrame>(message) &&
             !std::holds_alternative<Preparing>(message)) {
    return makeUnexpected("the server sent a message that only clients send");
  }
  return std::nullopt;
}

std::optional<WireError> ClientSession::checkWelcome(const Welcome& welcome, const WelcomeKey& key,
                                                     LocalTime now) {
  if (welcome.protocol_version != kProtocolVersion)
    return WireError{ErrorCode::kVersion, "the server has protocol version " +
                                              std::to_string(welcome.protocol_version) +
                                              ", this client " + std::to_string(kProtocolVersion)};
  if (welcome.datagram_key && !state_.protection.encrypted)
    return makeUnexpected("a key of datagrams arrived without TLS");
  if (!key.ok()) return key.error();
  if (auto refusal = settings_.origin.refuse(welcome.verifying_key)) {
    state_.untrusted = true;
    return WireError{ErrorCode::kUnexpected, std::move(*refusal)};
  }
  if (welcomed() && !state_.welcome_limiter.allow(now))
    return makeUnexpected("the server changes its origin too often");
  return std::nullopt;
}

std::optional<WireError> ClientSession::onWelcome(const Welcome& welcome, LocalTime now) {
  auto key = readKey(welcome);
  if (auto error = checkWelcome(welcome, key, now)) return error;
  if (welcomed()) {
    state_.pings.clear();  // their pongs would mix two media clocks
    if (receiver_ != nullptr) receiver_->disconnected(now);
  }
  state_.key = std::move(key).value();
  state_.is_description_new = !welcomed() || !(state_.description == welcome.description);
  state_.description = welcome.description;
  state_.stream = welcome.stream;
  state_.sealed_datagrams = welcome.datagram_key.has_value();
  if (settings_.sends_pings) state_.next_ping = *(state_.unanswered_since = now);
  state_.sent_pings = 0;
  state_.report_due = false;
  state_.last_delivery = {};
  if (wants_pictures_ != state_.hello_wants_pictures) request(Delivery{});
  ++state_.welcomes;
  ever_welcomed_ = true;
  if (receiver_ != nullptr) receiver_->connected(welcome.description, now);
  return std::nullopt;
}

std::optional<WireError> ClientSession::onFrame(CodedFrame& frame,
                                                std::span<const std::uint8_t> bytes,
                                                LocalTime now) {
  if (state_.key && !verifyFrame(bytes, state_.stream, *state_.key))
    return WireError{ErrorCode::kMalformed,
                     "a frame has no valid signature: somebody on the way may have changed it"};
  if (!state_.first_frame) state_.first_frame = now;
  if (receiver_ != nullptr) receiver_->frame(std::move(frame), now);
  return std::nullopt;
}

std::optional<WireError> ClientSession::onPart(Message& message) {
  const auto& part = std::get<PicturePart>(message);
  if (!settings_.wants_video) return makeUnexpected("a part of a picture that was not requested");
  state_.sends_receipts = true;
  state_.reduced = part.reduced;
  if (part.size > 0) {  // also in place of a picture that the server does not complete
    state_.picture.clear();
    state_.picture_bytes = part.size;
  }
  state_.picture.insert(state_.picture.end(), part.data.begin(), part.data.end());
  if (state_.picture.size() > state_.picture_bytes)
    return WireError{ErrorCode::kMalformed, "the parts of a picture are larger than the picture"};
  if (state_.picture.size() < state_.picture_bytes) return std::nullopt;
  auto picture = decode(state_.picture);
  state_.picture_bytes = 0;
  state_.picture.clear();
  if (!picture.ok()) return picture.error();
  if (!std::holds_alternative<VideoFrame>(picture.value()))
    return WireError{ErrorCode::kMalformed, "the parts of a picture are no picture"};
  message = std::move(picture).value();
  return std::nullopt;
}

void ClientSession::requestPictures(bool wanted) {
  if (std::exchange(wants_pictures_, wanted) == wanted || !welcomed()) return;
  request(state_.delivery.value_or(state_.last_delivery));  // poll() adds the pictures
}

void ClientSession::onPong(const Pong& pong, LocalTime now) {
  if (settings_.sends_pings) {  // a pong counts only for a ping that was sent, and once
    const auto sent = std::find(state_.pings.begin(), state_.pings.end(), pong.t0);
    if (sent == state_.pings.end()) return;
    state_.pings.erase(sent);
    state_.unanswered_since.reset();
  }
  if (receiver_ != nullptr) receiver_->pong(pong, now);
}

void ClientSession::onDescription(const StreamDescription& description, LocalTime now) {
  state_.description = description;
  if (receiver_ != nullptr) receiver_->describe(description, now);
}

bool ClientSession::request(const Control& control) {
  if (!welcomed() || state_.controls.size() >= kMostRequests) return false;
  state_.controls.push_back(control);
  return true;
}

std::optional<Message> ClientSession::poll(LocalTime now) {
  if (!state_.is_open) return std::nullopt;
  if (std::exchange(state_.hello_due, false)) {
    state_.hello_wants_pictures = wants_pictures_;
    return Hello{kProtocolVersion,       settings_.client_name, wants_pictures_,     true,
                 settings_.access_token, settings_.wants_video, settings_.wants_acts};
  }
  if (!welcomed()) return std::nullopt;
  if (state_.delivery) {
    state_.last_delivery = *std::exchange(state_.delivery, std::nullopt);
    if (settings_.wants_video) state_.last_delivery.pictures = wants_pictures_;
    return state_.last_delivery;
  }
  if (now >= state_.receipt_due) {
    state_.receipt_due = LocalTime::max();
    state_.receipt_sent = now;
    return Receipt{state_.received_bytes, now - state_.received_at};
  }
  if (!state_.controls.empty()) {
    state_.has_requested = true;
    const Control next = state_.controls.front();
    state_.controls.pop_front();
    return next;
  }
  if (std::exchange(state_.report_due, false)) return makeReport();
  if (now < state_.next_ping) return std::nullopt;
  return makePing(now);
}

Message ClientSession::makePing(LocalTime now) {
  const bool in_burst = ++state_.sent_pings < ClockSync::kBurst;
  state_.next_ping = now + (in_burst ? settings_.burst_interval : settings_.ping_interval);
  state_.report_due = !in_burst && receiver_ != nullptr;
  state_.pings.push_back(now);
  if (state_.pings.size() > kMaxPingsOut) state_.pings.pop_front();
  return Ping{now};
}

ReceiverReport ClientSession::makeReport() const {
  const ReceiverCounts& counts = receiver_->counts();
  return {counts.received,
          counts.lost,
          counts.late,
          1e3 * toSeconds(receiver_->stream().playout_delay_target),
          1e6 * toSeconds(receiver_->clockErrorBound()),
          in_contact_};
}

LocalTime ClientSession::nextDeadline() const {
  if (!state_.is_open) return LocalTime::max();
  if (!state_.unanswered_since) return state_.deadline;
  return std::min(state_.deadline, *state_.unanswered_since + settings_.pong_limit);
}

std::optional<SessionEnd> ClientSession::expire(LocalTime now) const {
  if (now < nextDeadline()) return std::nullopt;
  if (now >= state_.deadline) return SessionEnd{.why = state_.overdue, .code = ErrorCode::kTimeout};
  return SessionEnd{
      .why = "the server answers no pings, so the client cannot synchronize the clocks",
      .code = ErrorCode::kTimeout};
}

bool ClientSession::isPermanent(const SessionEnd& end) const {
  if (end.untrusted || end.code == ErrorCode::kVersion || end.code == ErrorCode::kUnauthorized ||
      end.code == ErrorCode::kForbidden)
    return true;
  const bool speaks_something_else = end.code == ErrorCode::kMalformed ||
                                     end.code == ErrorCode::kTooLarge ||
                                     end.code == ErrorCode::kUnexpected;
  return !ever_welcomed_ && (end.no_such_server || speaks_something_else);
}

std::optional<Duration> ClientSession::close(const SessionEnd& end, LocalTime now) {
  const bool was_good = state_.first_frame && now - *state_.first_frame >= settings_.good_after;
  if (welcomed() && receiver_ != nullptr) receiver_->disconnected(now);
  state_ = State();
  if (isPermanent(end)) return std::nullopt;
  if (was_good) pause_ = settings_.first_retry;
  return std::exchange(pause_, std::min(2 * pause_, settings_.last_retry));
}

}  // namespace hapticast::client
