// SPDX-License-Identifier: MIT
// Messages of the helper process to the client, over a socket that preserves message boundaries
// (SOCK_SEQPACKET). When one side ends, the system closes its socket. The other side detects the
// end by that.
// Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "client/device/hapticast_device.h"
#include "common/time.hpp"

namespace hapticast::client {

/// File descriptors that the client passes to the helper: its end of the socket, and the page.
inline constexpr int kHelperSocket = 3;
inline constexpr int kHelperPage = 4;

/// One message.
struct HelperMessage {
  enum class Kind : char {
    kLog = 'L',      ///< `text` is a line for the user
    kFound = 'F',    ///< a connected device: `text` is its serial number, `problem` as in list()
    kListed = 'N',   ///< the end of the list
    kOpened = 'O',   ///< the device is open; `profile` has its properties
    kAbsent = 'A',   ///< the device cannot be opened; `text` is the reason
    kRefused = 'R',  ///< the driver or an option cannot be used; `text` is the reason
  };
  Kind kind = Kind::kLog;
  std::string text = {};
  std::string problem = {};
  hapticast_profile profile = {};
};

inline constexpr std::size_t kLongestMessage_bytes = 1024;

/// Sends a message. Texts are cut to 300 characters. Does not block: a message that does not fit
/// into the socket is dropped. Returns false if the other side has ended.
bool sendMessage(int socket, const HelperMessage& message) noexcept;

/// Parses a message. Converts each text to one line of printable characters. Returns nullopt if
/// `bytes` has no valid message.
std::optional<HelperMessage> parseMessage(std::string_view bytes);

/// Result of receiveMessage().
struct Received {
  bool ended = false;  ///< the other side has ended
  std::optional<HelperMessage> message;
};

/// Receives the next message, and waits for it at most until `deadline`. Drops an invalid message.
Received receiveMessage(int socket, LocalTime deadline);

}  // namespace hapticast::client
