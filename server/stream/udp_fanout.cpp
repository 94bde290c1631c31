// SPDX-License-Identifier: MIT
#include "server/stream/udp_fanout.hpp"

#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace hapticast::server {

namespace {

/// Control data of a message: source address and segment size.
class Control {
 public:
  /// Sets the source address. `v6`: version of the socket and of all its targets; IPv4 addresses
  /// are mapped.
  void source(const asio::ip::address& from, bool v6) {
    if (from.is_unspecified() || (from.is_v6() && !v6)) return;
    if (!v6) {
      in_pktinfo info{};
      const auto bytes = from.to_v4().to_bytes();
      std::memcpy(&info.ipi_spec_dst, bytes.data(), bytes.size());
      return add(IPPROTO_IP, IP_PKTINFO, info);
    }
    in6_pktinfo info{};
    const auto address =
        from.is_v6() ? from.to_v6() : asio::ip::make_address_v6(asio::ip::v4_mapped, from.to_v4());
    const auto bytes = address.to_bytes();
    std::memcpy(&info.ipi6_addr, bytes.data(), bytes.size());
    info.ipi6_ifindex = static_cast<decltype(info.ipi6_ifindex)>(address.scope_id());
    add(IPPROTO_IPV6, IPV6_PKTINFO, info);
  }
  void cutAfter(std::size_t bytes) {
    add(IPPROTO_UDP, UDP_SEGMENT, static_cast<std::uint16_t>(bytes));
  }
  void hand(msghdr& message) {
    message.msg_control = size_ > 0 ? bytes_.data() : nullptr;
    message.msg_controllen = size_;
  }

 private:
  template <class Info>
  void add(int level, int type, const Info& info) {
    cmsghdr header{};
    header.cmsg_level = level;
    header.cmsg_type = type;
    header.cmsg_len = CMSG_LEN(sizeof info);
    std::memcpy(bytes_.data() + size_, &header, sizeof header);
    std::memcpy(bytes_.data() + size_ + CMSG_LEN(0), &info, sizeof info);
    size_ += CMSG_SPACE(sizeof info);
  }

  alignas(
      cmsghdr) std::array<unsigned char, CMSG_SPACE(sizeof(in6_pktinfo)) + CMSG_SPACE(2)> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace

DatagramCounts& DatagramCounts::operator+=(const DatagramCounts& other) {
  sent += other.sent;
  dropped += other.dropped;
  failed += other.failed;
  bytes += other.bytes;
  return *this;
}

struct UdpFanout::Address {
  explicit Address(const DatagramTarget& target)
      : token(tokenBytes(target.token)),
        to(target.to),
        copies(target.copies),
        counts(target.counts) {
    source.source(target.from, to.protocol() == asio::ip::udp::v6());
  }

  /// Fills a message of datagrams, each preceded by the token. `parts` needs two entries for each
  /// body.
  void fill(msghdr& message, iovec* parts, Control& control,
            std::span<const std::vector<std::uint8_t>* const> bodies) {
    message = {};
    message.msg_name = to.data();
    message.msg_namelen = static_cast<socklen_t>(to.size());
    message.msg_iov = parts;
    message.msg_iovlen = 2 * bodies.size();
    for (const auto* body : bodies) {
      *parts++ = {token.data(), token.size()};
      *parts++ = {const_cast<std::uint8_t*>(body->data()), body->size()};  // only read
    }
    control = source;
    if (bodies.size() > 1) control.cutAfter(token.size() + bodies.front()->size());
    control.hand(message);
  }

  TokenBytes token;
  asio::ip::udp::endpoint to;
  std::size_t copies;
  std::shared_ptr<DatagramCounts> counts;
  Control source;
};

struct UdpFanout::Batch {
  std::array<mmsghdr, kBatch> messages;
  std::array<Control, kBatch> controls;
  std::array<Cursor, kBatch> at;
  std::array<iovec, 2 * kBatch> parts;
};

UdpFanout::UdpFanout(asio::ip::udp::socket& socket)
    : socket_(socket), batch_(std::make_unique<Batch>()) {}

UdpFanout::~UdpFanout() = default;

void UdpFanout::send(std::vector<SignedDatagrams> newest_first,
                     const std::vector<DatagramTarget>& targets) {
  dropRest();
  frames_ = std::move(newest_first);
  messages_.reserve(frames_.size());
  for (const SignedDatagrams& each : frames_) messages_.push_back(splitSegments(each));
  targets_.reserve(targets.size());
  for (const DatagramTarget& each : targets) targets_.emplace_back(each);
  if (!waiting_) sendPending();
}

bool UdpFanout::sendNow(const std::vector<std::uint8_t>& body, const DatagramTarget& target) {
  Address address(target);
  return sendOne(body, address) > 0;
}

std::size_t UdpFanout::sendOne(const std::vector<std::uint8_t>& body, Address& to) {
  msghdr message;
  std::array<iovec, 2> parts;
  Control control;
  const std::array bodies{&body};
  to.fill(message, parts.data(), control, bodies);
  const auto sent = ::sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent < 0 ? 0 : static_cast<std::size_t>(sent);
}

void UdpFanout::sendSingly(const Segments& segments, Address& to) {
  for (const auto* body : segments) {
    const std::size_t bytes = sendOne(*body, to);
    ++(bytes > 0 ? to.counts->sent : to.counts->failed);
    to.counts->bytes += bytes;
  }
}

std::vector<UdpFanout::Segments> UdpFanout::splitSegments(const SignedDatagrams& bodies) {
  Segments left;
  left.reserve(bodies->size());
  for (const auto& body : *bodies) left.push_back(&body);
  std::stable_sort(left.begin(), left.end(),
                   [](const auto* a, const auto* b) { return a->size() > b->size(); });
  std::vector<Segments> messages;
  bool full = true;
  for (const auto* body : left) {
    if (full) messages.emplace_back();
    Segments& message = messages.back();
    message.push_back(body);
    full = message.size() == kMostSegments || body->size() < message.front()->size();
  }
  return messages;
}

bool UdpFanout::finishRound(Cursor& cursor) const {
  for (; cursor.frame < messages_.size(); cursor = {cursor.frame + 1, 0, 0}) {
    const std::size_t messages = messages_[cursor.frame].size();
    for (; cursor.message < messages; cursor = {cursor.frame, cursor.message + 1, 0}) {
      for (; cursor.target < targets_.size(); ++cursor.target) {
        if (targets_[cursor.target].copies > cursor.frame) return true;
      }
    }
  }
  return false;
}

void UdpFanout::dropRest() {
  for (; finishRound(next_); ++next_.target)
    targets_[next_.target].counts->dropped += at(next_).size();
  frames_.clear();
  messages_.clear();
  targets_.clear();
  next_ = {};
}

void UdpFanout::sendPending() {
  for (std::size_t sent = 0; finishRound(next_); sent += kBatch) {
    if (sent >= kAtOnce) {
      waiting_ = true;
      return asio::post(socket_.get_executor(), [this] {
        waiting_ = false;
        sendPending();
      });
    }
    if (!sendBatch()) return scheduleSend();
  }
}

void UdpFanout::scheduleSend() {
  waiting_ = true;
  socket_.async_wait(asio::socket_base::wait_write, [this](const boost::system::error_code& ec) {
    if (ec) return;  // the socket is closed, and UdpFanout may be destroyed
    waiting_ = false;
    sendPending();
  });
}

bool UdpFanout::sendBatch() {
  unsigned count = 0;
  std::size_t datagrams = 0;
  for (Cursor cursor = next_; finishRound(cursor); ++cursor.target, ++count) {
    const Segments& segments = at(cursor);
    if (datagrams + segments.size() > kBatch) break;
    batch_->messages[count].msg_len = 0;
    batch_->at[count] = cursor;
    targets_[cursor.target].fill(batch_->messages[count].msg_hdr,
                                 batch_->parts.data() + 2 * datagrams, batch_->controls[count],
                                 segments);
    datagrams += segments.size();
  }
  const int taken = ::sendmmsg(socket_.native_handle(), batch_->messages.data(), count,
                               MSG_DONTWAIT | MSG_NOSIGNAL);
  if (taken < 0) {
    if (errno == EAGAIN || errno == EWOULDBLOCK) return false;
    if (errno == EINTR) return true;
    // A vanished address, a filter, or a network without segmentation: affects this target only.
    sendSingly(at(next_), targets_[next_.target]);
    ++next_.target;
    return true;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
    DatagramCounts& counts = *targets_[batch_->at[i].target].counts;
    counts.sent += at(batch_->at[i]).size();
    counts.bytes += batch_->messages[i].msg_len;
  }
  if (taken > 0) next_ = batch_->at[static_cast<std::size_t>(taken) - 1];
  ++next_.target;
  return true;
}

}  // namespace hapticast::server
