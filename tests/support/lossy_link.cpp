// SPDX-License-Identifier: MIT
#include "tests/support/lossy_link.hpp"

#include <algorithm>
#include <deque>

namespace hapticast::testing {

namespace {
using asio::ip::tcp;
using asio::ip::udp;
constexpr auto kPoll = std::chrono::milliseconds(1);
constexpr std::size_t kChunkBytes = 16U << 10U;
constexpr std::size_t kMostWaitingBytes = 4U << 20U;  // beyond it the sender has to wait
constexpr int kPortsTried = 20;
constexpr std::size_t kLeastReceiveBytes = 64U << 10U;

/// Lets TCP's sender sense the link: at most `way`'s queue waits to be read, in segments of
/// Ethernet. Without a rate nothing waits, so nothing is limited. A buffer below
/// kLeastReceiveBytes makes TCP itself stall.
void limitReceiveBuffer(tcp::socket& socket, const LinkProfile& way) {
  if (way.rate_bits_s <= 0.0) return;
  using SegmentBytes = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_MAXSEG>;
  boost::system::error_code ignored;
  const std::size_t bytes = std::max(way.queue_bytes, kLeastReceiveBytes);
  socket.set_option(asio::socket_base::receive_buffer_size(static_cast<int>(bytes)), ignored);
  socket.set_option(SegmentBytes(LinkModel::kSegmentBytes), ignored);
}

udp::endpoint sameNumber(const tcp::endpoint& endpoint) {
  return {endpoint.address(), endpoint.port()};
}
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

struct LossyLink::Stream {
  struct Chunk {
    LocalTime due;
    std::vector<std::uint8_t> bytes;
  };
  Stream(tcp::socket& source, tcp::socket& sink, LinkWay& way, std::uint32_t flow)
      : from(source), to(sink), timer(source.get_executor()), model(way, flow) {}
  tcp::socket& from;
  tcp::socket& to;
  asio::steady_timer timer;
  LinkModel model;
  std::deque<Chunk> waiting;
  std::size_t waiting_bytes = 0;
  bool ended = false;
};

LossyLink::LossyLink(asio::io_context& io, const tcp::endpoint& listen_at,
                     const tcp::endpoint& server, const LinkProfile& up, const LinkProfile& down)
    : up_{up, {}, {}},
      down_{down, {}, {}},
      acceptor_(io),
      server_(server),
      datagrams_(io, up_, down_) {
  for (int i = 1;; ++i) {
    listen(listen_at);
    if (datagrams_.open(sameNumber(acceptor_.local_endpoint()), sameNumber(server))) break;
    acceptor_.close();
    if (listen_at.port() != 0 || i == kPortsTried)
      throw boost::system::system_error(asio::error::address_in_use, "UDP");
  }
  asio::co_spawn(
      io, [this] { return acceptAll(); }, asio::detached);
}

LossyLink::LossyLink(asio::io_context& io, std::uint16_t target, const LinkProfile& profile)
    : LossyLink(io, {asio::ip::address_v4::loopback(), 0},
                {asio::ip::address_v4::loopback(), target}, profile, profile) {}

void LossyLink::listen(const tcp::endpoint& at) {
  acceptor_.open(at.protocol());
  acceptor_.set_option(asio::socket_base::reuse_address(true));
  acceptor_.bind(at);
  acceptor_.listen();
}

void LossyLink::stall(bool stalled) {
  stalled_ = stalled;
  datagrams_.stall(stalled);
}

void LossyLink::cut() {
  for (const auto& each : relays_) {
    if (const auto relay = each.lock()) relay->close();
  }
  relays_.clear();
  datagrams_.forget();
}

void LossyLink::close() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  cut();
  datagrams_.close();
}

asio::awaitable<void> LossyLink::acceptAll() {
  while (acceptor_.is_open()) {
    auto relay = std::make_shared<Relay>(acceptor_.get_executor());
    boost::system::error_code ec;
    co_await acceptor_.async_accept(relay->near_side,
                                    asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
    limitReceiveBuffer(relay->near_side, up_.profile);
    relay->far_side.open(server_.protocol());
    limitReceiveBuffer(relay->far_side, down_.profile);
    co_await relay->far_side.async_connect(server_, asio::redirect_error(asio::use_awaitable, ec));
    if (ec) continue;  // closes the near side: nobody is there
    start(relay);
  }
}

void LossyLink::start(const std::shared_ptr<Relay>& relay) {
  std::erase_if(relays_, [](const auto& each) { return each.expired(); });
  relays_.push_back(relay);
  boost::system::error_code ignored;  // the delay is the model's affair
  relay->near_side.set_option(tcp::no_delay(true), ignored);
  relay->far_side.set_option(tcp::no_delay(true), ignored);
  const std::uint32_t flow = 4 * relayed_++;
  const auto executor = acceptor_.get_executor();
  for (const bool up : {true, false}) {
    auto stream = up ? std::make_shared<Stream>(relay->near_side, relay->far_side, up_, flow)
                     : std::make_shared<Stream>(relay->far_side, relay->near_side, down_, flow + 1);
    asio::co_spawn(
        executor, [this, relay, stream] { return take(relay, stream); }, asio::detached);
    asio::co_spawn(
        executor, [this, relay, stream] { return deliver(relay, stream); }, asio::detached);
  }
}

asio::awaitable<void> LossyLink::take(std::shared_ptr<Relay> relay,
                                      std::shared_ptr<Stream> stream) {
  asio::steady_timer pause(stream->from.get_executor());
  while (relay->near_side.is_open()) {
    boost::system::error_code ec;
    if (stalled_ || stream->waiting_bytes >= kMostWaitingBytes ||
        !stream->model.room(clock_.now(), LinkModel::kSegmentBytes)) {
      pause.expires_after(kPoll);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ec));
      continue;
    }
    const bool paced = (&stream->from == &relay->near_side ? up_ : down_).profile.rate_bits_s > 0.0;
    std::vector<std::uint8_t> bytes(paced ? LinkModel::kSegmentBytes : kChunkBytes);
    bytes.resize(co_await stream->from.async_read_some(
        asio::buffer(bytes), asio::redirect_error(asio::use_awaitable, ec)));
    if (ec) break;
    stream->waiting_bytes += bytes.size();
    const LocalTime due = stream->model.stream(clock_.now(), bytes.size());
    stream->waiting.push_back({due, std::move(bytes)});
    if (stream->waiting.size() == 1) stream->timer.cancel();
  }
  stream->ended = true;
  stream->timer.cancel();
}

asio::awaitable<void> LossyLink::deliver(std::shared_ptr<Relay> relay,
                                         std::shared_ptr<Stream> stream) {
  using TimePoint = asio::steady_timer::time_point;
  boost::system::error_code ec;
  while (!(stream->ended && stream->waiting.empty())) {
    const LocalTime now = clock_.now();
    if (stalled_ || stream->waiting.empty() || stream->waiting.front().due > now) {
      const LocalTime due = stalled_                  ? now + kPoll
                            : stream->waiting.empty() ? LocalTime::max()
                                                      : stream->waiting.front().due;
      stream->timer.expires_at(TimePoint(due.time_since_epoch()));
      co_await stream->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
      if (!relay->near_side.is_open()) co_return;
      continue;
    }
    const auto chunk = std::move(stream->waiting.front());
    stream->waiting.pop_front();
    stream->waiting_bytes -= chunk.bytes.size();
    co_await asio::async_write(stream->to, asio::buffer(chunk.bytes),
                               asio::redirect_error(asio::use_awaitable, ec));
    if (ec) break;
  }
  if (ec) {
    relay->close();
  } else {
    stream->to.shutdown(tcp::socket::shutdown_send, ec);
  }
}

}  // namespace hapticast::testing
