// SPDX-License-Identifier: MIT
#include "server/stream/datagram_sender.hpp"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

// Chosen: a frame's datagrams for some hundred viewers. The system's limit may be lower.
constexpr int kSendBuffer_bytes = 4 << 20;

std::vector<SignedDatagrams> mergeRound(const std::deque<SignedDatagrams>& frames) {
  return {frames.begin(), frames.end()};
}

}  // namespace

DatagramSender::DatagramSender(asio::io_context& io, const Clock& clock,
                               const asio::ip::tcp::endpoint& listener,
                               const StreamIdentity& identity, MulticastGroup* group)
    : socket_(io),
      clock_(clock),
      identity_(identity),
      group_(group),
      listener_port_(listener.port()),
      subscribers_(identity.stream),
      out_(socket_) {
  const auto require = [&](const boost::system::error_code& failed) {
    if (failed) throw std::runtime_error("cannot send datagrams: " + failed.message());
  };
  boost::system::error_code ec;
  asio::ip::udp::endpoint at(listener.address(), listener.port());
  require(socket_.open(at.protocol(), ec));
  if (at.address() == asio::ip::address_v6::any()) socket_.set_option(asio::ip::v6_only(false), ec);
  require(socket_.non_blocking(true, ec));
  socket_.set_option(asio::socket_base::send_buffer_size(kSendBuffer_bytes), ec);
  if (socket_.bind(at, ec)) {
    spdlog::info("UDP port {} is in use: the server sends datagrams from another port",
                 listener.port());
    at.port(0);
    require(socket_.bind(at, ec));
  }
  port_ = socket_.local_endpoint().port();
  if (group_ != nullptr) {
    group_out_ = std::make_unique<UdpFanout>(group_->socket());
    group_token_ = makeUnguessable();
  }
  asio::co_spawn(
      io, [this] { return readEchoes(); }, asio::detached);
}

void DatagramSender::offer(const Hosts& hosts, Welcome& welcome) {
  if (hosts.peer.is_unspecified() || hosts.local.is_unspecified()) return;
  welcome.datagram_token = subscribers_.add(hosts.peer, hosts.local);
  welcome.datagram_port = port_ == listener_port_ ? 0 : port_;
  if (group_ != nullptr) {
    const auto& at = group_->endpoint();
    welcome.group = DatagramGroup{at.address().to_string(), at.port(), group_token_};
    wanted_.store(true, std::memory_order_relaxed);
  }
}

void DatagramSender::changeOrigin(const StreamIdentity& identity) {
  identity_ = identity;
  last_.clear();
  out_.dropRest();
  if (group_out_) group_out_->dropRest();
  group_probed_at_.reset();
  counts_.viewers += subscribers_.restart(identity.stream);
  updateWanted();
}

void DatagramSender::removeViewer(std::uint64_t token) {
  counts_.viewers += subscribers_.remove(token);
  updateWanted();
}

void DatagramSender::setDelivery(std::uint64_t token, const Delivery& delivery) {
  subscribers_.setDelivery(token, delivery);
  updateWanted();
}

void DatagramSender::updateWanted() {
  const bool group = group_ != nullptr && subscribers_.size() > 0;
  wanted_.store(group || subscribers_.hasSubscribers(), std::memory_order_relaxed);
}

void DatagramSender::check(LocalTime now) {
  subscribers_.forget(now);
  updateWanted();
}

void DatagramSender::send(const EncodedFrame& frame) {
  if (!socket_.is_open()) return;
  if (!frame.datagrams) return last_.clear();
  last_.push_front(frame.datagrams);
  if (last_.size() > limits::kMostCopies) last_.pop_back();
  std::vector<DatagramTarget> targets;
  targets.reserve(subscribers_.size());
  subscribers_.forEachSubscriber(
      [&targets](std::uint64_t token, const UdpSubscribers::Viewer& viewer) {
        targets.push_back({token, *viewer.at, viewer.local, viewer.copies, viewer.counts});
      });
  // The last viewer receives some milliseconds later, so the order rotates.
  if (!targets.empty()) {
    const auto first = static_cast<std::ptrdiff_t>(frame.id % targets.size());
    std::rotate(targets.begin(), targets.begin() + first, targets.end());
  }
  out_.send(mergeRound(last_), targets);
  if (group_out_ && subscribers_.size() > 0) sendToGroup();
}

void DatagramSender::sendToGroup() {
  const DatagramTarget all{
      group_token_, group_->endpoint(), {}, subscribers_.groupCopies(), group_counts_};
  const LocalTime now = clock_.now();
  if (!group_probed_at_ || now - *group_probed_at_ >= kGroupProbeEvery) {
    group_probed_at_ = now;
    // If the system rejects this probe, the next one follows half a second later.
    (void)group_out_->sendNow(identity_.probe, all);
  }
  group_out_->send(mergeRound(last_), {all});
}

void DatagramSender::stop() {
  out_.dropRest();
  if (group_out_) group_out_->dropRest();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

asio::awaitable<void> DatagramSender::readEchoes() {
  std::array<std::uint8_t, kEchoBytes + 1> bytes{};  // one byte more detects longer datagrams
  while (socket_.is_open()) {
    boost::system::error_code ec;
    co_await socket_.async_wait(asio::socket_base::wait_read,
                                asio::redirect_error(asio::use_awaitable, ec));
    for (std::size_t i = 0; i < kMostEchoes && !ec && socket_.is_open(); ++i) {
      asio::ip::udp::endpoint from;
      const std::size_t size = socket_.receive_from(asio::buffer(bytes), from, 0, ec);
      if (!ec) onEcho(std::span(bytes).first(size), from);
    }
  }
}

void DatagramSender::onEcho(std::span<const std::uint8_t> bytes,
                            const asio::ip::udp::endpoint& from) {
  const AddressValidation verdict = subscribers_.onEcho(bytes, from, clock_.now());
  ++counts_.echoes[static_cast<std::size_t>(verdict)];
  if (verdict != AddressValidation::kValidated) return;
  const std::uint64_t token = readEcho(bytes)->token;
  const UdpSubscribers::Viewer& viewer = *subscribers_.find(token);
  // If the system rejects this probe, the next echo triggers another one.
  (void)out_.sendNow(identity_.probe, {token, from, viewer.local, 1, viewer.counts});
  updateWanted();
}

DatagramSenderCounts DatagramSender::counts() const {
  DatagramSenderCounts counts = counts_;
  counts.group = *group_counts_;
  counts.viewers += subscribers_.counts();
  return counts;
}

}  // namespace hapticast::server
