// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/dialect.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tests/support/framed.hpp"
#include "tests/support/websocket_frames.hpp"

namespace hapticast::testing {

namespace {

constexpr std::string_view kTopic = "f";

// MQTT 3.1.1: a type, the length of the rest as a varint, the rest.
constexpr std::uint8_t kConnect = 0x10, kPublish = 0x30, kSubscribe = 0x82;
constexpr std::size_t kConnackBytes = 4, kSubackBytes = 5;

std::optional<Envelope> mqttEnvelope(std::span<const std::uint8_t> bytes) {
  std::size_t rest = 0, head = 1;
  for (unsigned shift = 0;; shift += 7) {
    if (head >= bytes.size()) return std::nullopt;
    const std::uint8_t byte = bytes[head++];
    rest |= std::size_t{byte & 0x7FU} << shift;
    if (byte < 0x80) break;
  }
  const bool frame = (bytes[0] & 0xF0U) == kPublish;
  const std::size_t topic = frame ? 2 + kTopic.size() : 0;
  return Envelope{head + topic, rest - topic, 0};
}

std::vector<std::uint8_t> mqttMessage(std::uint8_t type, std::string_view head,
                                      std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes{type};
  std::size_t rest = head.size() + payload.size();
  for (; rest >= 0x80; rest >>= 7) bytes.push_back(static_cast<std::uint8_t>(rest | 0x80U));
  bytes.push_back(static_cast<std::uint8_t>(rest));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

std::string counted(std::string_view text) {
  return std::string{'\0', static_cast<char>(text.size())} + std::string(text);
}

void greetMqtt(int socket, bool subscribe) {
  const std::string hello = counted("MQTT") + '\x04' + '\x02' + std::string(2, '\0');  // for ever
  sendAll(socket, mqttMessage(kConnect,
                              hello + counted(std::to_string(socket) + "of" +
                                              (subscribe ? "crowd" : "source")),
                              {}));
  std::uint8_t answers[kConnackBytes + kSubackBytes]{};
  const std::size_t most = kConnackBytes + (subscribe ? kSubackBytes : 0);
  if (subscribe) {
    const std::string what = std::string{'\0', '\1'} + counted(kTopic) + '\0';
    sendAll(socket, mqttMessage(kSubscribe, what, {}));
  }
  const bool all = ::recv(socket, answers, most, MSG_WAITALL) == static_cast<ssize_t>(most);
  if (!all || answers[3] != 0) throw std::runtime_error("the broker does not take a viewer");
}

// NATS: lines; a message is its line, then as many bytes as that says, then the end of a line.
constexpr std::string_view kEnd = "\r\n";

std::optional<Envelope> natsEnvelope(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t end = text.find(kEnd);
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t head = end + kEnd.size();
  if (!text.starts_with("MSG ")) return Envelope{head, 0, 0};
  const std::string_view line = text.substr(0, end);
  return Envelope{head, std::stoul(std::string(line.substr(line.rfind(' ') + 1))), kEnd.size()};
}

std::span<const std::uint8_t> countBytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void readLine(int socket, std::string_view begin) {
  std::string line;
  for (char byte = 0; byte != '\n'; line += byte)
    require(::recv(socket, &byte, 1, 0) == 1, "no line from the broker");
  if (!line.starts_with(begin)) throw std::runtime_error("the broker says: " + line);
}

void greetNats(int socket, bool subscribe) {
  readLine(socket, "INFO");
  sendAll(socket, countBytes("CONNECT {\"verbose\":false,\"pedantic\":false}\r\nPING\r\n"));
  readLine(socket, "PONG");
  if (subscribe) sendAll(socket, countBytes("SUB " + std::string(kTopic) + " 1\r\n"));
}

// WebSocket (RFC 6455): a head of 2, 4 or 10 bytes; a server's has no mask.
std::optional<Envelope> webSocketEnvelope(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kTwoBytes = 126, kEightBytes = 127;
  if (bytes.size() < 2) return std::nullopt;
  if (bytes[0] != 0x82) throw std::runtime_error("the server sends what is no binary message");
  const std::size_t more = bytes[1] == kEightBytes ? 8 : bytes[1] == kTwoBytes ? 2 : 0;
  if (bytes.size() < 2 + more) return std::nullopt;
  std::size_t length = more > 0 ? 0 : bytes[1];
  for (const std::uint8_t each : bytes.subspan(2, more)) length = length << 8U | each;
  return Envelope{2 + more, length, 0};
}

void greetWebSocket(int socket) {
  // The page of a server may be opened by any address of it.
  sendAll(socket, countBytes("GET /stream HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                             "Origin: http://127.0.0.1\r\nConnection: Upgrade\r\n"
                             "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                             "Sec-WebSocket-Protocol: hapticast.3\r\n\r\n"));
  std::string answer;
  for (char byte = 0; !answer.ends_with("\r\n\r\n"); answer += byte)
    require(::recv(socket, &byte, 1, 0) == 1, "no answer from the server");
  if (!answer.starts_with("HTTP/1.1 101 "))
    throw std::runtime_error("the server opens no WebSocket: " + answer.substr(0, 60));
}

}  // namespace

void require(bool done, const char* what) {
  if (!done) throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

int findConnected(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return socket;
  ::close(socket);
  return -1;
}

void sendAll(int socket, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else {
      require(errno == EAGAIN || errno == EINTR, "cannot send");
      pollfd writable{socket, POLLOUT, 0};
      ::poll(&writable, 1, -1);
    }
  }
}

std::optional<Envelope> envelope(Transport way, std::span<const std::uint8_t> bytes) {
  if (way == Transport::kMqtt) return mqttEnvelope(bytes);
  if (way == Transport::kNats) return natsEnvelope(bytes);
  if (way == Transport::kWebSocket) return webSocketEnvelope(bytes);
  std::uint32_t length = 0;
  if (bytes.size() < sizeof length) return std::nullopt;
  std::memcpy(&length, bytes.data(), sizeof length);
  return Envelope{kPrefixBytes, length, 0};
}

std::vector<std::uint8_t> published(Transport way, std::span<const std::uint8_t> payload) {
  if (way == Transport::kMqtt) return mqttMessage(kPublish, counted(kTopic), payload);
  if (way == Transport::kWebSocket) return maskedFrame(0x82, {payload.begin(), payload.end()});
  if (way != Transport::kNats) return framed(payload);
  const std::string line =
      "PUB " + std::string(kTopic) + " " + std::to_string(payload.size()) + std::string(kEnd);
  std::vector<std::uint8_t> bytes(line.begin(), line.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  bytes.insert(bytes.end(), kEnd.begin(), kEnd.end());
  return bytes;
}

void greet(Transport way, int socket, bool subscribe) {
  if (way == Transport::kMqtt) greetMqtt(socket, subscribe);
  if (way == Transport::kNats) greetNats(socket, subscribe);
  if (way == Transport::kWebSocket) greetWebSocket(socket);
}

}  // namespace hapticast::testing
