// SPDX-License-Identifier: MIT
#include "client/discovery/server_list.hpp"

#include <algorithm>
#include <tuple>

#include "common/mdns.hpp"
#include "common/protocol/messages.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

auto identity(const FoundServer& server) {
  return std::tie(server.name, server.host, server.address.port);
}

std::string formatName(const FoundServer& server) {
  return printable(server.name, kMaxServiceName_bytes);
}

std::string formatVersion(const FoundServer& server) {
  if (server.version == kProtocolVersion) return "";
  if (server.version == 0) return "  (does not say its version)";
  return "  (protocol version " + std::to_string(server.version) + ", this client " +
         std::to_string(kProtocolVersion) + ")";
}

std::string inOneLine(std::size_t number, const FoundServer& server) {
  constexpr std::size_t kMaxHost_bytes = 64;  // chosen; a name of DNS may have 255
  const std::string plays = printable(server.plays, kMaxServicePlays_bytes);
  std::string line = "  " + std::to_string(number) + "  " + formatName(server) + "  at ";
  line.append(printable(server.host, kMaxHost_bytes)).append("  ");
  line.append(toString(server.address)).append("  ").append(server.interface_name);
  if (!plays.empty()) line.append("  plays ").append(plays);
  return line.append(formatVersion(server));
}

}  // namespace

std::vector<FoundServer> eachOnce(std::vector<FoundServer> found) {
  const auto order = [](const FoundServer& server) {
    return std::tuple_cat(
        identity(server),
        std::make_tuple(isV6(server.address), server.interface_name, server.address.host));
  };
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return order(a) < order(b); });
  const auto same = [](const auto& a, const auto& b) { return identity(a) == identity(b); };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  return found;
}

std::optional<FoundServer> only(const std::vector<FoundServer>& found, const std::string& name,
                                std::string& why) {
  std::optional<FoundServer> the_one;
  for (const FoundServer& each : found) {
    if (each.name != name) continue;
    if (the_one) {
      why = "more than one host announces this name: " + toString(the_one->address) + ", " +
            toString(each.address);
      return std::nullopt;
    }
    the_one = each;
  }
  if (!the_one) why = "no server announces this name";
  return the_one;
}

bool ServerList::update(const std::vector<FoundServer>& found) {
  bool changed = false;
  for (Line& line : lines_) {
    const bool there = std::find(found.begin(), found.end(), line.server) != found.end();
    changed = changed || there != line.there;
    line.there = there;
  }
  for (const FoundServer& each : found) {
    const auto known = [&each](const Line& line) { return line.server == each; };
    if (std::any_of(lines_.begin(), lines_.end(), known)) continue;
    if (lines_.size() == kMost) {
      changed = changed || !more_;
      more_ = true;
      break;
    }
    lines_.push_back({each});
    changed = true;
  }
  return changed;
}

bool ServerList::empty() const {
  return std::none_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.there; });
}

std::string ServerList::toText() const {
  std::vector<std::string> words;
  words.reserve(lines_.size() + 1);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].there) words.push_back(inOneLine(i + 1, lines_[i].server));
  }
  if (more_) words.emplace_back("  and more, which are not shown");
  return join(words, "\n");
}

std::optional<FoundServer> ServerList::choose(std::string_view typed, std::string& why) const {
  typed = trimmed(typed);
  const auto number = parseNumberInRange<std::uint64_t>(typed, 1, UINT64_MAX);
  const Line* chosen = nullptr;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const bool meant = number ? *number == i + 1 : formatName(lines_[i].server) == typed;
    if (!meant || !lines_[i].there) continue;
    if (chosen != nullptr) {
      why = "more than one has this name: type a number";
      return std::nullopt;
    }
    chosen = &lines_[i];
  }
  if (chosen == nullptr) {
    why = quote(printable(typed, typed.size())) + " is none of them: type a number or a name";
    return std::nullopt;
  }
  return chosen->server;
}

}  // namespace hapticast::client
