// SPDX-License-Identifier: MIT
// Which server is taken: the one that was asked for, or the one on this machine, or one that is
// found on the LAN and chosen by the user. Never one that nobody chose: any host can call itself a
// server, and this one moves a hand. Thread: each function says which.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/discovery/mdns_browser.hpp"
#include "client/discovery/terminal_input.hpp"
#include "client/net/dial.hpp"
#include "client/settings.hpp"

namespace hapticast::client {

class ServerSelector {
 public:
  explicit ServerSelector(const Settings& settings);

  /// For the connection, which tries again and again; this object outlives it. Its calls: network.
  [[nodiscard]] Dial dial();
  /// What is dialled now, for people. Thread: any.
  [[nodiscard]] std::string name() const;
  /// In the event loop: shows those that were found and reads what the user types, until the first
  /// connection. A text to be told, or nothing. Thread: main.
  std::optional<std::string> update(bool connected, LocalTime now);

 private:
  asio::awaitable<Dialled> dialAnnounced(asio::io_context& io, const Endpoint& server,
                                         Duration deadline, DialCancellation& stop);
  asio::awaitable<Dialled> dialChosen(asio::io_context& io, const Endpoint& server,
                                      Duration deadline, DialCancellation& stop);
  [[nodiscard]] std::optional<std::string> readServers();
  [[nodiscard]] std::string onInput(const std::string& typed);

  const Endpoint server_;
  const std::string announced_;
  const bool is_asking_;                  // nothing was asked for
  std::atomic<bool> none_here_{false};    // the server on this machine was tried
  std::unique_ptr<Discovery> discovery_;  // main; with announced_ also the network's
  mutable std::mutex mutex_;
  std::optional<FoundServer> chosen_;  // mutex_
  // Main:
  bool over_ = false;
  std::optional<LocalTime> next_look_;
  ServerList list_;
  bool logged_absent_ = false;
  TerminalLines terminal_;
  bool shown_ = false;  // on the terminal
};

/// --list: looks for two seconds and prints what was found. Whether there was any.
bool listServers();

}  // namespace hapticast::client
