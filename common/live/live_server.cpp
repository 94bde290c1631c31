// SPDX-License-Identifier: MIT
#include "common/live/live_server.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "common/transport/tcp_port.hpp"

namespace hapticast {

namespace {
constexpr std::chrono::milliseconds kPauseAfterAccept{20};  // chosen: bounds a flood of connections
}  // namespace

LiveServer::LiveServer(const Endpoint& address, const std::string& name,
                       std::vector<McapChannel> channels)
    : channels_(std::move(channels)),
      subscriptions_(channels_.size()),
      acceptor_(openPort(io_, address, "--live")),
      address_(describeAddress(acceptor_, address)),
      server_{makeServerInfo(name), makeAdvertisement(channels_), channels_.size(),
              [this] { return countWatchers() < kMostWatchers; },
              [this](Watcher& watcher, std::size_t channel, bool begins) {
                onSubscription(watcher, channel, begins);
              }},
      newest_(channels_.size()) {
  asio::co_spawn(
      io_, [this] { return acceptAll(); }, asio::detached);
  thread_ = std::jthread([this] { run(); });
}

LiveServer::~LiveServer() {
  asio::post(io_, [this] {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    for (const auto& each : watchers_) each->close();
  });
}

void LiveServer::run() {
  while (!io_.stopped()) {
    try {
      io_.run();
    } catch (const std::bad_alloc&) {
      // The handler's message is lost.
    }
  }
}

bool LiveServer::isWanted(std::size_t channel) const {
  return channels_[channel].is_state || subscriptions_[channel] > 0;
}

void LiveServer::push(std::size_t channel, std::uint64_t time_ns,
                      std::span<const std::uint8_t> data) {
  if (!isWanted(channel)) return;
  try {
    auto message = std::make_shared<const LiveMessage>(
        LiveMessage{channel, time_ns, {data.begin(), data.end()}});
    asio::post(io_, [this, message = std::move(message)] { deliver(message); });
  } catch (const std::bad_alloc&) {
    // The message is lost.
  }
}

void LiveServer::deliver(std::shared_ptr<const LiveMessage> message) {
  for (const auto& each : watchers_) each->send(message);
  if (channels_[message->channel].is_state) newest_[message->channel] = std::move(message);
}

asio::awaitable<void> LiveServer::acceptAll() {
  while (acceptor_.is_open()) {
    boost::system::error_code ec;
    auto socket = co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, ec));
    if (!acceptor_.is_open()) co_return;  // a connection that came before the end
    if (!ec) add(std::move(socket));
    pause_.expires_after(kPauseAfterAccept);
    co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

std::size_t LiveServer::countWatchers() const {
  return static_cast<std::size_t>(std::count_if(watchers_.begin(), watchers_.end(),
                                                [](const auto& each) { return each->hasPlace(); }));
}

void LiveServer::add(asio::ip::tcp::socket socket) {
  if (watchers_.size() - countWatchers() >= kMostSilent) {
    const auto oldest = std::find_if(watchers_.begin(), watchers_.end(),
                                     [](const auto& each) { return !each->hasPlace(); });
    (*oldest)->close();
    watchers_.erase(oldest);  // its coroutine ends by itself
  }
  try {
    watchers_.push_back(std::make_shared<Watcher>(std::move(socket), server_));
    asio::co_spawn(
        io_, [this, watcher = watchers_.back()] { return serve(watcher); }, asio::detached);
  } catch (const std::bad_alloc&) {
    // The connection is closed.
  }
}

asio::awaitable<void> LiveServer::serve(std::shared_ptr<Watcher> watcher) {
  try {
    co_await watcher->serve();
  } catch (const std::bad_alloc&) {
    watcher->close();
  }
  std::erase(watchers_, watcher);
}

void LiveServer::onSubscription(Watcher& watcher, std::size_t channel, bool begins) {
  if (!begins) {
    --subscriptions_[channel];
    return;
  }
  ++subscriptions_[channel];
  if (newest_[channel]) watcher.send(newest_[channel]);
}

}  // namespace hapticast
