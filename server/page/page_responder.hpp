// SPDX-License-Identifier: MIT
// Answers requests of HTTP on the port of the viewers: the files of the page, and at /stream the
// handshake of a WebSocket (RFC 6455, section 4.2). A page of another site can neither open the
// stream nor read the files: the request must name this server as its host, and the page of a
// WebSocket must come from the same host. Thread: the network's.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/transport/http_responder.hpp"
#include "server/page/page_files.hpp"

namespace hapticast::server {

/// Name of the subprotocol, with the version of the protocol.
inline constexpr std::string_view kSubprotocol = "hapticast.3";

struct HttpRequest;  // server/http/http_request.hpp

class PageResponder final : public HttpResponder {
 public:
  /// `host_names`: the names of this server in requests (isOwnHost()). `files`: those of the page.
  explicit PageResponder(std::vector<std::string> host_names,
                         std::span<const PageFile> files = listPageFiles())
      : host_names_(std::move(host_names)), files_(files) {}

  [[nodiscard]] HttpAnswer respond(std::string_view head, bool encrypted) override;

 private:
  [[nodiscard]] HttpAnswer answerGet(const HttpRequest& request, bool encrypted);
  using Content = std::shared_ptr<const std::vector<std::uint8_t>>;

  [[nodiscard]] HttpAnswer showFile(const PageFile& file, bool gzip);
  /// Returns the content of `file` without compression. It stays in memory for later requests.
  [[nodiscard]] const Content& findInflated(const PageFile& file);

  std::vector<std::string> host_names_;
  std::span<const PageFile> files_;
  std::map<const PageFile*, Content> inflated_;
};

}  // namespace hapticast::server
