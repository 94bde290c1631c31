// SPDX-License-Identifier: MIT
#include "client/device/helper/messages.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr std::size_t kLongestText = 300;
constexpr std::string_view kKinds = "LFNOAR";

/// Text from a driver becomes one printable line.
std::string toLine(std::string_view text) { return sanitizeUtf8(text.substr(0, kLongestText)); }

}  // namespace

std::optional<HelperMessage> parseMessage(std::string_view bytes) {
  if (bytes.empty() || kKinds.find(bytes.front()) == std::string_view::npos) return std::nullopt;
  HelperMessage message{.kind = static_cast<HelperMessage::Kind>(bytes.front())};
  bytes.remove_prefix(1);
  if (message.kind == HelperMessage::Kind::kOpened) {
    if (bytes.size() != sizeof message.profile) return std::nullopt;
    std::memcpy(&message.profile, bytes.data(), bytes.size());
    message.profile.serial[sizeof message.profile.serial - 1] = '\0';
    return message;
  }
  const std::size_t split = bytes.find('\0');
  message.text = toLine(bytes.substr(0, split));
  if (split != std::string_view::npos) message.problem = toLine(bytes.substr(split + 1));
  return message;
}

bool sendMessage(int socket, const HelperMessage& message) noexcept {
  std::array<char, kLongestMessage_bytes> bytes;
  std::size_t size = 0;
  bytes[size++] = static_cast<char>(message.kind);
  const auto append = [&](const std::string& text) {
    const std::size_t length = std::min(text.size(), kLongestText);
    std::copy_n(text.data(), length, bytes.data() + size);
    size += length;
  };
  if (message.kind == HelperMessage::Kind::kOpened) {
    std::memcpy(bytes.data() + size, &message.profile, sizeof message.profile);
    size += sizeof message.profile;
  } else {
    append(message.text);
    if (!message.problem.empty()) {
      bytes[size++] = '\0';
      append(message.problem);
    }
  }
  return send(socket, bytes.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 ||
         (errno != EPIPE && errno != ECONNRESET);
}

Received receiveMessage(int socket, LocalTime deadline) {
  const SteadyClock clock;
  const auto left = std::max(deadline - clock.now(), Duration::zero());
  pollfd ready{.fd = socket, .events = POLLIN, .revents = 0};
  const timespec timeout{static_cast<time_t>(left.count() / 1'000'000'000),
                         static_cast<long>(left.count() % 1'000'000'000)};
  if (ppoll(&ready, 1, &timeout, nullptr) <= 0) return {};
  std::array<char, kLongestMessage_bytes> bytes;
  const ssize_t size = recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR))
    return {.ended = true, .message = std::nullopt};
  if (size < 0) return {};
  return {.ended = false, .message = parseMessage({bytes.data(), static_cast<std::size_t>(size)})};
}

}  // namespace hapticast::client
