// SPDX-License-Identifier: MIT
// Servers that were found on the LAN, as they are shown and chosen. All of it is what strangers say
// of themselves. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/endpoint.hpp"

namespace hapticast::client {

struct FoundServer {
  std::string name;  ///< as it came
  std::string host;
  Endpoint address;
  std::string interface_name;
  std::string plays;
  std::uint32_t version = 0;  ///< of the protocol; 0: not said
  bool operator==(const FoundServer&) const = default;
};

/// Each server once, by the first of its addresses: IPv4 first, then by interface.
[[nodiscard]] std::vector<FoundServer> eachOnce(std::vector<FoundServer> found);

/// The only one that is announced by this name. Error: why there is none, or which hosts say so.
[[nodiscard]] std::optional<FoundServer> only(const std::vector<FoundServer>& found,
                                              const std::string& name, std::string& why);

/// A list that only grows: a number, once shown, means the same server for good, so that nobody can
/// slip in under the user's finger.
class ServerList {
 public:
  static constexpr std::size_t kMost = 32;  ///< chosen: what one can still look through

  /// What is there now, eachOnce(). Whether the list has changed.
  bool update(const std::vector<FoundServer>& found);
  [[nodiscard]] bool empty() const;
  /// A line for each that is there, and one where there are more; without the last line's end.
  [[nodiscard]] std::string toText() const;
  /// The one with the number or the name that was typed; else `why` says what is wrong with it.
  [[nodiscard]] std::optional<FoundServer> choose(std::string_view typed, std::string& why) const;

 private:
  struct Line {
    FoundServer server;
    bool there = true;
  };
  std::vector<Line> lines_;
  bool more_ = false;
};

}  // namespace hapticast::client
