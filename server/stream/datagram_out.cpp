// SPDX-License-Identifier: MIT
#include "server/stream/datagram_out.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace hapticast::server {

namespace {

/// Room for the control data that names the source address.
using Control = std::array<unsigned char, CMSG_SPACE(sizeof(in6_pktinfo))>;

template <class Info>
std::size_t write(Control& control, int level, int type, const Info& info) {
  msghdr whole{};
  whole.msg_control = control.data();
  whole.msg_controllen = CMSG_SPACE(sizeof info);
  cmsghdr* const header = CMSG_FIRSTHDR(&whole);
  header->cmsg_level = level;
  header->cmsg_type = type;
  header->cmsg_len = CMSG_LEN(sizeof info);
  std::memcpy(CMSG_DATA(header), &info, sizeof info);
  return whole.msg_controllen;
}

/// `v6`: the socket's kind, which may send to IPv4 as well.
std::size_t writeSource(Control& control, const asio::ip::address& from, bool v6) {
  if (from.is_unspecified() || (from.is_v6() && !v6)) return 0;
  if (!v6) {
    in_pktinfo info{};
    const auto bytes = from.to_v4().to_bytes();
    std::memcpy(&info.ipi_spec_dst, bytes.data(), bytes.size());
    return write(control, IPPROTO_IP, IP_PKTINFO, info);
  }
  in6_pktinfo info{};
  const auto address =
      from.is_v6() ? from.to_v6() : asio::ip::make_address_v6(asio::ip::v4_mapped, from.to_v4());
  const auto bytes = address.to_bytes();
  std::memcpy(&info.ipi6_addr, bytes.data(), bytes.size());
  info.ipi6_ifindex = static_cast<decltype(info.ipi6_ifindex)>(address.scope_id());
  return write(control, IPPROTO_IPV6, IPV6_PKTINFO, info);
}

}  // namespace

DatagramCounts& DatagramCounts::operator+=(const DatagramCounts& other) {
  sent += other.sent;
  dropped += other.dropped;
  failed += other.failed;
  return *this;
}

struct DatagramOut::Address {
  explicit Address(const DatagramTarget& target, bool v6)
      : token(tokenBytes(target.token)),
        to(target.to),
        copies(target.copies),
        counts(target.counts),
        control_size(writeSource(control, target.from, v6)) {}

  /// The parts of a datagram, token first.
  void fill(msghdr& message, std::array<iovec, 2>& parts, const std::vector<std::uint8_t>& body) {
    parts = {iovec{token.data(), token.size()},
             iovec{const_cast<std::uint8_t*>(body.data()), body.size()}};  // is only read
    message = {};
    message.msg_name = to.data();
    message.msg_namelen = static_cast<socklen_t>(to.size());
    message.msg_iov = parts.data();
    message.msg_iovlen = parts.size();
    message.msg_control = control_size > 0 ? control.data() : nullptr;
    message.msg_controllen = control_size;
  }

  TokenBytes token;
  asio::ip::udp::endpoint to;
  std::size_t copies;
  std::shared_ptr<DatagramCounts> counts;
  alignas(cmsghdr) Control control{};
  std::size_t control_size;
};

struct DatagramOut::Batch {
  std::array<mmsghdr, kBatch> messages;
  std::array<std::array<iovec, 2>, kBatch> parts;
  std::array<Cursor, kBatch> at;
};

DatagramOut::DatagramOut(asio::ip::udp::socket& socket)
    : socket_(socket), batch_(std::make_unique<Batch>()) {}

DatagramOut::~DatagramOut() = default;

void DatagramOut::send(std::vector<SharedBodies> newest_first,
                       const std::vector<DatagramTarget>& targets) {
  dropRest();
  frames_ = std::move(newest_first);
  const bool v6 = socket_.local_endpoint().protocol() == asio::ip::udp::v6();
  targets_.reserve(targets.size());
  for (const DatagramTarget& each : targets) targets_.emplace_back(each, v6);
  if (!waiting_) go();
}

bool DatagramOut::sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target) {
  Address address(target, socket_.local_endpoint().protocol() == asio::ip::udp::v6());
  msghdr message;
  std::array<iovec, 2> parts;
  address.fill(message, parts, body);
  return ::sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

void DatagramOut::stop() { dropRest(); }

bool DatagramOut::settle(Cursor& cursor) const {
  for (; cursor.frame < frames_.size(); cursor = {cursor.frame + 1, 0, 0}) {
    const std::size_t bodies = frames_[cursor.frame]->size();
    for (; cursor.body < bodies; cursor = {cursor.frame, cursor.body + 1, 0}) {
      for (; cursor.target < targets_.size(); ++cursor.target) {
        if (targets_[cursor.target].copies > cursor.frame) return true;
      }
    }
  }
  return false;
}

void DatagramOut::dropRest() {
  for (; settle(next_); ++next_.target) ++targets_[next_.target].counts->dropped;
  frames_.clear();
  targets_.clear();
  next_ = {};
}

void DatagramOut::go() {
  for (std::size_t sent = 0; settle(next_); sent += kBatch) {
    if (sent >= kAtOnce) {
      waiting_ = true;
      return asio::post(socket_.get_executor(), [this] {
        waiting_ = false;
        go();
      });
    }
    if (!sendBatch()) return goLater();
  }
}

void DatagramOut::goLater() {
  waiting_ = true;
  socket_.async_wait(asio::socket_base::wait_write, [this](const boost::system::error_code& ec) {
    if (ec) return;  // the socket is closed, and this may be gone
    waiting_ = false;
    go();
  });
}

bool DatagramOut::sendBatch() {
  unsigned count = 0;
  for (Cursor at = next_; count < kBatch && settle(at); ++at.target, ++count) {
    batch_->messages[count].msg_len = 0;
    batch_->at[count] = at;
    targets_[at.target].fill(batch_->messages[count].msg_hdr, batch_->parts[count],
                             (*frames_[at.frame])[at.body]);
  }
  const int taken = ::sendmmsg(socket_.native_handle(), batch_->messages.data(), count,
                               MSG_DONTWAIT | MSG_NOSIGNAL);
  if (taken < 0) {
    if (errno == EAGAIN || errno == EWOULDBLOCK) return false;
    if (errno == EINTR) return true;
    ++targets_[next_.target].counts->failed;  // an address that is gone, a filter: it alone
    ++next_.target;
    return true;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i)
    ++targets_[batch_->at[i].target].counts->sent;
  if (taken > 0) next_ = batch_->at[static_cast<std::size_t>(taken) - 1];
  ++next_.target;
  return true;
}

}  // namespace hapticast::server
