// SPDX-License-Identifier: MIT
// Requests of HTTP on the port of the viewers: the head of a request, and the interface to what
// answers it. Each connection carries one request. Its answer ends the connection, or turns it into
// a WebSocket. Thread: any; at most one at a time for each object.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hapticast {

/// Collects the head of a request: its request line and fields, with the empty line at the end.
class HttpHead {
 public:
  static constexpr std::size_t kMostBytes = 8192;  ///< a choice, as of many servers

  /// Adds bytes of the connection. Returns true once the head is complete, or longer than
  /// kMostBytes. Requires that it has not returned true before.
  [[nodiscard]] bool add(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view kEnd = "\r\n\r\n";
    const std::size_t from = bytes_.size() - std::min(bytes_.size(), kEnd.size() - 1);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    const auto end = std::search(bytes_.begin() + static_cast<std::ptrdiff_t>(from), bytes_.end(),
                                 kEnd.begin(), kEnd.end());
    size_ = static_cast<std::size_t>(end - bytes_.begin());
    if (end != bytes_.end()) size_ += kEnd.size();
    return end != bytes_.end() || bytes_.size() > kMostBytes;
  }
  /// Returns the head, after add() has returned true. A head above kMostBytes may be incomplete.
  [[nodiscard]] std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes_.data()), size_};
  }
  /// Returns the bytes behind the head.
  [[nodiscard]] std::span<const std::uint8_t> rest() const {
    return std::span(bytes_).subspan(size_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t size_ = 0;
};

/// The answer to one request.
struct HttpAnswer {
  std::string head;                    ///< status line and fields, with the empty line
  std::span<const std::uint8_t> body;  ///< bytes that live as long as `owner`, or for ever
  std::shared_ptr<const void> owner;   ///< null: the body lives for ever, or is empty
  bool is_websocket = false;           ///< the connection is a WebSocket after the head
  bool for_this_machine = false;       ///< the client addressed this machine as its own
  std::string problem;                 ///< one line for the log; empty: a usual request
};

/// Answers requests.
class HttpResponder {
 public:
  virtual ~HttpResponder() = default;
  /// Returns the answer to the request with this head (HttpHead). `encrypted`: it came by TLS.
  [[nodiscard]] virtual HttpAnswer respond(std::string_view head, bool encrypted) = 0;
};

}  // namespace hapticast
