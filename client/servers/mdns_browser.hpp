// SPDX-License-Identifier: MIT
// Search for servers that announce themselves on the LAN by DNS-SD. The object searches through the
// Avahi daemon during its whole lifetime. Without Avahi it finds nothing.
// Thread: any; the search runs in a thread of the library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/servers/server_list.hpp"

namespace hapticast::client {

class Discovery {
 public:
  Discovery();
  ~Discovery();
  Discovery(const Discovery&) = delete;
  Discovery& operator=(const Discovery&) = delete;

  /// Returns the servers that are announced at present, each once (removeDuplicates()).
  [[nodiscard]] std::vector<FoundServer> servers() const;
  /// Returns the reason why no search is possible at present, in a few words. The text is empty
  /// while the search runs.
  [[nodiscard]] std::string describeAbsence() const;

 private:
  struct Browser;
  std::unique_ptr<Browser> browser_;
};

}  // namespace hapticast::client
