// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/crowd.hpp"

#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <thread>

#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

using std::chrono::milliseconds;
constexpr std::size_t kUnderWay =
    16;  // not welcomed yet; servers keep only so many pending clients
constexpr std::size_t kHeadBytes = 64;  // holds id and media time of a frame
constexpr std::size_t kNeededBytes = kHeadBytes - kMostEnvelopeHead;
constexpr std::size_t kMostSmallBytes = 64U << 10U;
constexpr auto kPingEvery = std::chrono::seconds(1);  // as clients do
constexpr int kMostPings = 100;                       // without a look at what has come
constexpr Duration kEchoEvery = std::chrono::seconds(10);
constexpr auto kLookEvery = milliseconds(1);
constexpr auto kJoinWithin = std::chrono::seconds(60);

class Varints {
 public:
  explicit Varints(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint64_t next() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !bytes_.empty(); shift += 7) {
      const std::uint8_t byte = bytes_.front();
      bytes_ = bytes_.subspan(1);
      value |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) break;
    }
    return value;
  }
  std::int64_t fixed64() {
    std::int64_t value = 0;
    if (bytes_.size() < sizeof value) return 0;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

void say(Transport way, int socket, const Message& message) {
  const auto bytes = published(way, encode(message));
  require(::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0, "cannot send");
}

}  // namespace

std::optional<FrameHead> frameHead(std::span<const std::uint8_t> payload) {
  constexpr std::uint64_t kFrame = 6 << 3 | 2, kEpoch = 1 << 3, kId = 2 << 3, kTime = 3 << 3 | 1;
  Varints fields(payload);
  if (fields.next() != kFrame) return std::nullopt;
  (void)fields.next();  // its length
  FrameHead head;
  std::uint64_t field = fields.next();
  if (field == kEpoch) {
    (void)fields.next();
    field = fields.next();
  }
  if (field == kId) {
    head.id = fields.next();
    field = fields.next();
  }
  if (field == kTime) head.media_time_ns = fields.fixed64();
  return head;
}

struct Crowd::Viewer {
  Viewer() = default;
  ~Viewer() {
    if (socket >= 0) ::close(socket);
    if (datagrams >= 0) ::close(datagrams);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  int socket = -1;
  std::array<std::uint8_t, kHeadBytes> head{};  // the next message begins here
  std::size_t held = 0;
  std::size_t skip = 0;             // bytes of the message before that nobody looks at
  std::vector<std::uint8_t> small;  // a message that is looked at, as far as it has come
  std::size_t small_bytes = 0;      // of it in all; 0: none is on its way
  std::size_t small_head = 0;       // of these, before its payload
  bool welcomed = false;
  bool watching = false;
  int datagrams = -1;  // their socket
  Echo its_echo;
  LocalTime next_echo;
  struct Frame {
    std::uint64_t id = 0;
    std::size_t missing = 0;
    std::vector<bool> had;
  };
  std::array<Frame, 4> frames;  // by their id; of which not all parts have come
};

Crowd::Crowd(const sockaddr_in& server, std::size_t viewers, Transport way)
    : server_(server), way_(way), epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  viewers_.resize(viewers);
}

Crowd::~Crowd() {
  viewers_.clear();
  ::close(epoll_);
}

void Crowd::connect(Viewer& viewer) {
  viewer.welcomed = !ours(way_) && way_ != Transport::kPlainUdp;
  if (viewer.welcomed) ++welcomed_;
  if (way_ == Transport::kPlainUdp) {
    openDatagrams(viewer, server_);
    require(::send(viewer.datagrams, "", 1, 0) == 1, "cannot send");
    return;
  }
  viewer.socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  require(viewer.socket >= 0, "no socket");
  const int on = 1;
  ::setsockopt(viewer.socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  require(
      ::connect(viewer.socket, reinterpret_cast<const sockaddr*>(&server_), sizeof server_) == 0,
      "cannot connect");
  greet(way_, viewer.socket, true);
  epoll_event event{EPOLLIN, {.ptr = &viewer}};
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, viewer.socket, &event);
  if (ours(way_))
    say(way_, viewer.socket, Hello{kProtocolVersion, "viewers", false, way_ != Transport::kUdp});
}

void Crowd::join() {
  const LocalTime give_up = clock_.now() + kJoinWithin;
  std::size_t connected = 0;
  while (watching_ < viewers_.size() || (ours(way_) && !sync_.ready())) {
    if (clock_.now() > give_up) {
      throw std::runtime_error("after a minute " + std::to_string(welcomed_) +
                               " are welcomed and " + std::to_string(watching_) + " get frames");
    }
    while (connected < viewers_.size() && connected - welcomed_ < kUnderWay) {
      viewers_[connected] = std::make_unique<Viewer>();
      connect(*viewers_[connected++]);
    }
    wait(milliseconds(5));
    if (ours(way_) && viewers_[0]->welcomed && !sync_.ready()) ping(*viewers_[0]);
    pingAll();
  }
}

void Crowd::begin() {
  seen_.clear();
  delivered_ = 0;
  counted_from_ = newest_ + 1;
  counting_ = true;
}

void Crowd::end(std::uint64_t last) {
  counting_ = false;
  const std::uint64_t frames = last + 1 - counted_from_;
  passage_.frames += frames;
  passage_.expected += frames * viewers_.size();
  for (const auto& [id, seen] : seen_) {
    if (id <= last) passage_.delivered += seen.viewers;
  }
}

void Crowd::wait(Duration at_most) {
  std::array<epoll_event, 256> events{};
  auto timeout = static_cast<int>(std::chrono::ceil<milliseconds>(at_most).count());
  for (std::size_t count = events.size(); count == events.size(); timeout = 0) {
    const int got = ::epoll_wait(epoll_, events.data(), events.size(), timeout);
    count = static_cast<std::size_t>(std::max(got, 0));
    for (std::size_t i = 0; i < count; ++i) read(*static_cast<Viewer*>(events[i].data.ptr));
  }
}

void Crowd::pingAll() {
  if (!ours(way_)) return;
  // One after the other, each as often as it should: in a crowd nobody is in step.
  const LocalTime now = clock_.now();
  const auto most = static_cast<Duration::rep>(viewers_.size());
  for (int i = 0; i < kMostPings && next_ping_at_ <= now; ++i) {
    next_ping_at_ = std::max(next_ping_at_ + Duration(kPingEvery) / most, now - kPingEvery);
    const auto& viewer = viewers_[next_ping_++ % viewers_.size()];
    if (!viewer || !viewer->welcomed) continue;
    ping(*viewer);
    if (viewer->datagrams >= 0 && viewer->next_echo <= now) echo(*viewer);
  }
}

void Crowd::ping(Viewer& viewer) { say(way_, viewer.socket, Ping{clock_.now()}); }

void Crowd::echo(Viewer& viewer) {
  const EchoBytes bytes = echoBytes(viewer.its_echo);
  require(::send(viewer.datagrams, bytes.data(), bytes.size(), MSG_DONTWAIT) >= 0, "no echo");
  viewer.next_echo = clock_.now() + (viewer.watching ? kEchoEvery : Duration(0));
}

void Crowd::readDatagrams(Viewer& viewer) {
  std::array<std::array<std::uint8_t, kDatagramHeaderBytes>, 32> heads{};
  std::array<iovec, 32> parts{};
  std::array<mmsghdr, 32> messages{};
  for (std::size_t i = 0; i < heads.size(); ++i) {
    parts[i] = {heads[i].data(), heads[i].size()};  // the rest is thrown away in the kernel
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  for (std::size_t count = heads.size(); count == heads.size();) {
    const int got =
        ::recvmmsg(viewer.datagrams, messages.data(), messages.size(), MSG_DONTWAIT, nullptr);
    count = got > 0 ? static_cast<std::size_t>(got) : 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (messages[i].msg_len == 1) {  // an answer
        viewer.welcomed = true;
        ++welcomed_;
        continue;
      }
      std::array<std::uint8_t, kDatagramHeaderBytes + kSignatureBytes> bytes{};
      std::copy(heads[i].begin(), heads[i].end(), bytes.begin());
      if (const auto read = readDatagram(bytes)) datagram(viewer, read->header);
    }
  }
}

void Crowd::datagram(Viewer& viewer, const DatagramHeader& header) {
  if (header.probe()) return;
  Viewer::Frame& of = viewer.frames[header.frame % viewer.frames.size()];
  if (of.id > header.frame) return;
  if (of.id < header.frame) {
    of.id = header.frame;
    of.missing = header.parts;
    of.had.assign(header.parts, false);
  }
  if (of.had[header.part]) return;
  of.had[header.part] = true;
  const std::size_t bytes = std::size_t{header.parts} * kMostPieceBytes;  // somewhat too many
  if (--of.missing == 0) frame(viewer, of.id, header.media_time.time_since_epoch(), bytes);
}

void Crowd::read(Viewer& viewer) {
  if (viewer.datagrams >= 0) readDatagrams(viewer);
  while (viewer.socket >= 0) {
    ssize_t size = 0;
    if (viewer.skip > 0) {  // thrown away in the kernel, without a copy
      size = ::recv(viewer.socket, nullptr, viewer.skip, MSG_TRUNC | MSG_DONTWAIT);
      if (size > 0) viewer.skip -= static_cast<std::size_t>(size);
    } else if (viewer.small.size() < viewer.small_bytes) {
      const std::size_t before = viewer.small.size();
      viewer.small.resize(viewer.small_bytes);
      size = ::recv(viewer.socket, viewer.small.data() + before, viewer.small_bytes - before,
                    MSG_DONTWAIT);
      viewer.small.resize(before + static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    } else {
      size = ::recv(viewer.socket, viewer.head.data() + viewer.held, kHeadBytes - viewer.held,
                    MSG_DONTWAIT);
      if (size > 0) viewer.held += static_cast<std::size_t>(size);
    }
    if (size == 0) throw std::runtime_error("the server has closed a connection");
    require(size > 0 || errno == EAGAIN || errno == EINTR, "a connection has ended");
    if (size < 0) return;
    while (take(viewer)) {
    }
  }
}

bool Crowd::take(Viewer& viewer) {
  if (viewer.skip > 0) return false;
  if (viewer.small_bytes > 0) {
    if (viewer.small.size() < viewer.small_bytes) return false;
    message(viewer, std::span(viewer.small).subspan(viewer.small_head));
    viewer.small.clear();
    viewer.small_bytes = 0;
  }
  const auto message = envelope(way_, std::span(viewer.head).first(viewer.held));
  if (!message) return false;
  const std::size_t whole = message->whole();
  if (viewer.held < std::min(whole, message->head + kNeededBytes)) return false;
  const std::size_t here = std::min(viewer.held, whole);
  const std::span<const std::uint8_t> held(viewer.head.data(), here);
  if (const auto head = frameHead(held.subspan(message->head))) {
    if (way_ != Transport::kUdp)
      frame(viewer, head->id, Duration(head->media_time_ns), message->payload);
    viewer.skip = whole - here;
  } else if (!ours(way_)) {
    viewer.skip = whole - here;
  } else {
    if (whole > kMostSmallBytes) throw std::runtime_error("a message that is no frame is too long");
    viewer.small.assign(held.begin(), held.end());
    viewer.small_bytes = whole;
    viewer.small_head = message->head;
  }
  std::copy(viewer.head.begin() + static_cast<std::ptrdiff_t>(here),
            viewer.head.begin() + static_cast<std::ptrdiff_t>(viewer.held), viewer.head.begin());
  viewer.held -= here;
  return viewer.held > 0 || viewer.small.size() == viewer.small_bytes;
}

void Crowd::message(Viewer& viewer, std::span<const std::uint8_t> payload) {
  const auto decoded = decode(payload);
  if (!decoded.ok()) throw std::runtime_error("the server sends what is no message");
  if (const auto* const error = std::get_if<WireError>(&decoded.value()))
    throw std::runtime_error("the server says: " + error->message);
  if (const auto* const welcome = std::get_if<Welcome>(&decoded.value())) {
    viewer.welcomed = true;
    ++welcomed_;
    if (way_ == Transport::kUdp) askForDatagrams(viewer, *welcome);
  }
  const auto* const pong = std::get_if<Pong>(&decoded.value());
  if (pong != nullptr && &viewer == viewers_[0].get())
    sync_.add(pong->t0, pong->t1, pong->t2, clock_.now());
}

void Crowd::askForDatagrams(Viewer& viewer, const Welcome& welcome) {
  if (welcome.datagram_token == 0) throw std::runtime_error("the server sends no datagrams");
  sockaddr_in to = server_;
  if (welcome.datagram_port != 0) to.sin_port = htons(welcome.datagram_port);
  openDatagrams(viewer, to);
  viewer.its_echo = {welcome.datagram_token, welcome.stream};
  echo(viewer);
  say(way_, viewer.socket, Delivery{false, true, 1});
}

void Crowd::openDatagrams(Viewer& viewer, const sockaddr_in& to) {
  viewer.datagrams = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  require(viewer.datagrams >= 0 &&
              ::connect(viewer.datagrams, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0,
          "no socket for datagrams");
  const int buffer_bytes = 1 << 20;
  ::setsockopt(viewer.datagrams, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  epoll_event event{EPOLLIN, {.ptr = &viewer}};
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, viewer.datagrams, &event);
}

void Crowd::frame(Viewer& viewer, std::uint64_t id, Duration media_time, std::size_t bytes) {
  if (!viewer.watching) {
    viewer.watching = true;
    ++watching_;
  }
  newest_ = std::max(newest_, id);
  if (!counting_ || id < counted_from_) return;
  const LocalTime now = clock_.now();
  Seen& seen = seen_[id];
  if (seen.viewers++ == 0) seen.first = now;
  ++delivered_;
  passage_.bytes += bytes;
  passage_.spread.add((now - seen.first).count());
  const Duration media_now =
      now.time_since_epoch() + (ours(way_) ? sync_.offset(now) : Duration(0));
  passage_.latency.add((media_now - media_time).count());
}

void receiveFor(std::span<Crowd* const> crowds, Duration time, const std::function<bool()>& done) {
  const SteadyClock clock;
  const LocalTime until = clock.now() + time;
  for (LocalTime now = clock.now(); now < until && !(done && done()); now = clock.now()) {
    // Who slept in wait() would be woken by each message, at the cost of the server that sends it:
    // viewers on machines of their own do not cost that.
    std::this_thread::sleep_for(std::min<Duration>(until - now, kLookEvery));
    for (Crowd* const crowd : crowds) {
      crowd->wait(Duration(0));
      crowd->pingAll();
    }
  }
}

}  // namespace hapticast::testing
