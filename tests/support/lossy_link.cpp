// SPDX-License-Identifier: MIT
#include "tests/support/lossy_link.hpp"

#include <algorithm>
#include <deque>

namespace hapticast::testing {

namespace {
using asio::ip::tcp;
constexpr auto kPoll = std::chrono::milliseconds(1);
constexpr std::size_t kMaxWaiting = 64;  // chunks; beyond it the sender feels it
}  // namespace

struct LossyLink::Relay {
  explicit Relay(const asio::any_io_executor& executor) : near_side(executor), far_side(executor) {}
  void close() {
    boost::system::error_code ignored;
    near_side.close(ignored);
    far_side.close(ignored);
  }
  tcp::socket near_side;
  tcp::socket far_side;
};

struct LossyLink::Way {
  using Clock = asio::steady_timer::clock_type;
  struct Chunk {
    Clock::time_point due;
    std::vector<std::uint8_t> bytes;
  };
  Way(tcp::socket& source, tcp::socket& sink)
      : from(source), to(sink), timer(source.get_executor()) {}
  tcp::socket& from;
  tcp::socket& to;
  asio::steady_timer timer;
  std::deque<Chunk> waiting;
  bool ended = false;
};

LossyLink::LossyLink(asio::io_context& io, std::uint16_t target, Profile profile)
    : acceptor_(io, {asio::ip::address_v4::loopback(), 0}),
      target_(target),
      profile_(profile),
      random_(profile.seed) {
  asio::co_spawn(
      io, [this] { return acceptAll(); }, asio::detached);
}

void LossyLink::cut() {
  for (const auto& each : relays_) {
    if (const auto relay = each.lock()) relay->close();
  }
  relays_.clear();
}

void LossyLink::close() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  cut();
}

asio::awaitable<void> LossyLink::acceptAll() {
  while (acceptor_.is_open()) {
    auto relay = std::make_shared<Relay>(acceptor_.get_executor());
    boost::system::error_code ec;
    co_await acceptor_.async_accept(relay->near_side,
                                    asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
    co_await relay->far_side.async_connect({asio::ip::address_v4::loopback(), target_},
                                           asio::redirect_error(asio::use_awaitable, ec));
    if (ec) continue;  // closes the near side: nobody is there
    relays_.push_back(relay);
    for (const bool up : {true, false}) {
      auto way = up ? std::make_shared<Way>(relay->near_side, relay->far_side)
                    : std::make_shared<Way>(relay->far_side, relay->near_side);
      const auto executor = acceptor_.get_executor();
      asio::co_spawn(
          executor, [this, relay, way] { return take(relay, way); }, asio::detached);
      asio::co_spawn(
          executor, [this, relay, way] { return deliver(relay, way); }, asio::detached);
    }
  }
}

asio::awaitable<void> LossyLink::take(std::shared_ptr<Relay> relay, std::shared_ptr<Way> way) {
  asio::steady_timer pause(way->from.get_executor());
  auto last_due = Way::Clock::now();
  while (relay->near_side.is_open()) {
    boost::system::error_code ec;
    if (stalled_ || way->waiting.size() >= kMaxWaiting) {
      pause.expires_after(kPoll);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ec));
      continue;
    }
    std::vector<std::uint8_t> bytes(16U << 10U);
    bytes.resize(co_await way->from.async_read_some(asio::buffer(bytes),
                                                    asio::redirect_error(asio::use_awaitable, ec)));
    if (ec) break;
    std::uniform_int_distribution<std::int64_t> jitter(0, profile_.jitter.count());
    last_due = std::max(last_due, Way::Clock::now() + profile_.delay + Duration(jitter(random_)));
    way->waiting.push_back({last_due, std::move(bytes)});
    way->timer.cancel();
  }
  way->ended = true;
  way->timer.cancel();
}

asio::awaitable<void> LossyLink::deliver(std::shared_ptr<Relay> relay, std::shared_ptr<Way> way) {
  boost::system::error_code ec;
  while (!(way->ended && way->waiting.empty())) {
    const auto now = Way::Clock::now();
    if (stalled_ || way->waiting.empty() || way->waiting.front().due > now) {
      way->timer.expires_at(stalled_               ? now + kPoll
                            : way->waiting.empty() ? Way::Clock::time_point::max()
                                                   : way->waiting.front().due);
      co_await way->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
      if (!relay->near_side.is_open()) co_return;
      continue;
    }
    const auto chunk = std::move(way->waiting.front());
    way->waiting.pop_front();
    co_await asio::async_write(way->to, asio::buffer(chunk.bytes),
                               asio::redirect_error(asio::use_awaitable, ec));
    if (ec) break;
  }
  if (ec) {
    relay->close();
  } else {
    way->to.shutdown(tcp::socket::shutdown_send, ec);
  }
}

}  // namespace hapticast::testing
