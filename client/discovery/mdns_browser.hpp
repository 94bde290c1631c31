// SPDX-License-Identifier: MIT
// Looks for servers that are announced on the LAN, by Avahi, as long as it lives. Thread: any; a
// library's own does the looking.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/discovery/server_list.hpp"

namespace hapticast::client {

class Discovery {
 public:
  Discovery();
  ~Discovery();
  Discovery(const Discovery&) = delete;
  Discovery& operator=(const Discovery&) = delete;

  /// Those that are there now, eachOnce().
  [[nodiscard]] std::vector<FoundServer> servers() const;
  /// Why nothing can be looked for at present, in a few words; empty while it can.
  [[nodiscard]] std::string absent() const;

 private:
  struct Browser;
  std::unique_ptr<Browser> browser_;
};

}  // namespace hapticast::client
