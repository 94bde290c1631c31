// SPDX-License-Identifier: MIT
#include "common/live/watcher.hpp"

#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <utility>

namespace hapticast {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::uint32_t kMostHead_bytes = 8192;  // as the port of --http
constexpr std::chrono::seconds kHandshake{5};    // chosen
constexpr std::chrono::seconds kWarnEvery{1};    // chosen
constexpr std::chrono::seconds kSilence{30};     // a ping comes after half of it

auto into(boost::system::error_code& error) {
  return asio::redirect_error(asio::use_awaitable, error);
}

/// Returns the host of HOST or HOST:PORT without the port.
std::string_view cutPort(std::string_view authority) {
  if (authority.starts_with('[')) return authority.substr(0, authority.find(']') + 1);
  return authority.substr(0, authority.find(':'));
}

bool isAddress(std::string_view host) {
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  boost::system::error_code failed;
  (void)asio::ip::make_address(std::string(host), failed);
  return !failed;
}

/// Returns whether a watcher offers the live protocol among others.
bool offersProtocol(std::string_view offered) {
  for (const auto& each : http::token_list(beast::string_view(offered.data(), offered.size())))
    if (std::string_view(each.data(), each.size()) == kLiveProtocol) return true;
  return false;
}

std::string_view find(const http::request<http::empty_body>& request, http::field field) {
  const auto value = request[field];
  return {value.data(), value.size()};
}

/// Returns why a request for a WebSocket is refused, with its status; an empty text: it is not.
std::pair<http::status, std::string> refuse(const http::request<http::empty_body>& request,
                                            bool has_place) {
  if (!websocket::is_upgrade(request) ||
      !offersProtocol(find(request, http::field::sec_websocket_protocol)))
    return {http::status::upgrade_required,
            "This port has Foxglove's WebSocket protocol: open it with Lichtblick or Foxglove.\n"};
  const std::string_view origin = find(request, http::field::origin);
  if (!isTrustedPage(origin, find(request, http::field::host)))
    return {http::status::forbidden,
            "Pages of other sites may not watch: open Lichtblick as a program, or from "
            "localhost.\n"};
  if (!has_place)
    return {http::status::service_unavailable, "Too many programs watch already: close one.\n"};
  return {http::status::ok, ""};
}

}  // namespace

bool isTrustedPage(std::string_view origin, std::string_view host) {
  if (origin.empty() || origin == "file://") return true;
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return false;
  const std::string_view page = cutPort(origin.substr(scheme + 3));
  if (page == "localhost" || page == "127.0.0.1" || page == "[::1]") return true;
  return isAddress(page) && page == cutPort(host);
}

struct Watcher::Socket {
  using Tcp = beast::basic_stream<asio::ip::tcp, asio::any_io_executor, beast::simple_rate_policy>;

  explicit Socket(asio::ip::tcp::socket socket) : web(std::move(socket)) {}
  Tcp& tcp() { return beast::get_lowest_layer(web); }

  websocket::stream<Tcp> web;
  beast::flat_buffer received{kMostRequestBytes};
};

Watcher::Watcher(asio::ip::tcp::socket socket, const Server& server)
    : socket_(std::make_unique<Socket>(std::move(socket))), server_(server) {
  socket_->tcp().rate_policy().read_limit(kMostBytesPerSecond);
}

Watcher::~Watcher() {
  for (const auto& [number, channel] : subscriptions_)
    server_.onSubscription(*this, channel, false);
}

asio::awaitable<void> Watcher::serve() {
  if (!co_await accept()) co_return;
  is_open_ = true;
  push({server_.info, nullptr});
  push({server_.advertisement, nullptr});
  for (;;) {
    boost::system::error_code ec;
    socket_->received.clear();
    co_await socket_->web.async_read(socket_->received, into(ec));
    if (ec) break;
    const auto bytes = socket_->received.cdata();
    const auto request = decodeLiveRequest({static_cast<const char*>(bytes.data()), bytes.size()});
    if (request) {
      obey(*request);
    } else {
      push({makeWarning("this server knows the requests subscribe and unsubscribe only"), nullptr});
    }
  }
  close();
}

asio::awaitable<bool> Watcher::accept() {
  auto& [web, received] = *socket_;
  Socket::Tcp& tcp = socket_->tcp();
  tcp.expires_after(kHandshake);
  http::request_parser<http::empty_body> parser;
  parser.header_limit(kMostHead_bytes);
  boost::system::error_code ec;
  co_await http::async_read_header(tcp, received, parser, into(ec));
  if (ec) co_return false;
  if (const auto [status, text] = refuse(parser.get(), server_.hasPlace());
      status != http::status::ok) {
    http::response<http::string_body> response(status, parser.get().version(), text);
    response.set(http::field::content_type, "text/plain");
    response.keep_alive(false);
    response.prepare_payload();
    co_await http::async_write(tcp, response, into(ec));
    co_return false;
  }
  has_place_ = true;
  tcp.expires_never();  // the WebSocket has limits of its own
  web.set_option(websocket::stream_base::timeout{kHandshake, kSilence, true});
  web.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(http::field::sec_websocket_protocol,
                 beast::string_view(kLiveProtocol.data(), kLiveProtocol.size()));
  }));
  web.read_message_max(kMostRequestBytes);
  web.auto_fragment(false);
  co_await web.async_accept(parser.get(), into(ec));
  co_return !ec;
}

void Watcher::obey(const LiveRequest& request) {
  for (const auto& each : request.begin) begin(each);
  for (const std::uint32_t number : request.end) {
    const auto found = subscriptions_.find(number);
    if (found == subscriptions_.end()) continue;
    const std::size_t channel = found->second;
    subscriptions_.erase(found);
    server_.onSubscription(*this, channel, false);
  }
}

void Watcher::begin(const LiveRequest::Subscription& subscription) {
  if (subscription.channel == 0 || subscription.channel > server_.channels ||
      subscriptions_.size() >= kMostSubscriptions ||
      !subscriptions_.try_emplace(subscription.number, subscription.channel - 1).second) {
    push({makeWarning("the subscription " + std::to_string(subscription.number) +
                      " names no channel, is there already, or is one too many"),
          nullptr});
    return;
  }
  server_.onSubscription(*this, subscription.channel - 1, true);
}

void Watcher::send(const std::shared_ptr<const LiveMessage>& message) {
  for (const auto& [number, channel] : subscriptions_)
    if (channel == message->channel) push({"", message, number});
}

void Watcher::push(Waiting waiting) {
  if (!is_open_) return;
  const std::size_t size = waiting.size() + sizeof(Waiting);
  if (waiting_bytes_ + size > kMostWaitingBytes) {
    ++lost_;
    if (std::chrono::steady_clock::now() - warned_at_ >= kWarnEvery) warnOfLost();
    return;
  }
  enqueue(std::move(waiting));
}

void Watcher::warnOfLost() {
  warned_at_ = std::chrono::steady_clock::now();
  // Beyond the limit, so that a watcher that stays too slow gets it, too.
  enqueue({makeWarning(std::to_string(std::exchange(lost_, 0)) +
                       " messages are lost, because this watcher is too slow"),
           nullptr});
}

void Watcher::enqueue(Waiting waiting) {
  waiting_bytes_ += waiting.size() + sizeof(Waiting);
  waiting_.push_back(std::move(waiting));
  if (std::exchange(writes_, true)) return;
  asio::co_spawn(
      socket_->web.get_executor(), [self = shared_from_this()] { return self->writeAll(); },
      asio::detached);
}

asio::awaitable<void> Watcher::writeAll() {
  while (is_open_ && !waiting_.empty()) {
    const Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= next.size() + sizeof(Waiting);
    boost::system::error_code ec;
    socket_->web.binary(next.message != nullptr);
    if (next.message) {
      const auto head = makeDataHead(next.subscription, next.message->time_ns);
      const std::array both{asio::buffer(head), asio::buffer(next.message->data)};
      co_await socket_->web.async_write(both, into(ec));
    } else {
      co_await socket_->web.async_write(asio::buffer(next.text), into(ec));
    }
    if (ec) close();
    if (is_open_ && waiting_.empty() && lost_ > 0) warnOfLost();
  }
  writes_ = false;
}

void Watcher::close() {
  is_open_ = false;
  socket_->tcp().close();
}

}  // namespace hapticast
