// SPDX-License-Identifier: MIT
#include "tests/bench/viewers/crowd.hpp"

#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "tests/support/framed.hpp"

namespace hapticast::testing {

namespace {

using std::chrono::milliseconds;
constexpr std::size_t kUnderWay = 16;   // not welcomed yet; servers keep only so many strangers
constexpr std::size_t kHeadBytes = 64;  // holds id and media time of a frame
constexpr std::size_t kNeededBytes = 40;
constexpr std::size_t kMostSmallBytes = 64U << 10U;
constexpr auto kPingEvery = std::chrono::seconds(1);  // as clients do
constexpr int kMostPings = 100;                       // without a look at what has come
constexpr auto kStragglers = milliseconds(500);
constexpr auto kJoinWithin = std::chrono::seconds(60);

struct FrameHead {
  std::uint64_t id = 0;
  std::int64_t media_time_ns = 0;
};

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

/// The first fields of a Message that holds a HapticFrame (proto/hapticast.proto); nullopt: it
/// holds something else.
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

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

void say(int socket, const Message& message) {
  const auto bytes = framed(encode(message));
  if (::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) fail("cannot send");
}

}  // namespace

struct Crowd::Viewer {
  Viewer() = default;
  ~Viewer() {
    if (socket >= 0) ::close(socket);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  int socket = -1;
  std::array<std::uint8_t, kHeadBytes> head{};  // the next message begins here
  std::size_t held = 0;
  std::size_t skip = 0;             // bytes of the message before that nobody looks at
  std::vector<std::uint8_t> small;  // a message that is looked at, as far as it has come
  std::size_t small_bytes = 0;      // of it in all; 0: none is on its way
  bool welcomed = false;
  bool watching = false;
};

Crowd::Crowd(const sockaddr_in& server, std::size_t viewers, bool plain)
    : server_(server), plain_(plain), epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  viewers_.resize(viewers);
}

Crowd::~Crowd() {
  viewers_.clear();
  ::close(epoll_);
}

void Crowd::connect(Viewer& viewer) {
  viewer.socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (viewer.socket < 0) fail("no socket");
  const int on = 1;
  ::setsockopt(viewer.socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(viewer.socket, reinterpret_cast<const sockaddr*>(&server_), sizeof server_) != 0)
    fail("cannot connect");
  epoll_event event{EPOLLIN, {.ptr = &viewer}};
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, viewer.socket, &event);
  if (!plain_) say(viewer.socket, Hello{kProtocolVersion, "viewers", false, true});
  viewer.welcomed = plain_;
  if (plain_) ++welcomed_;
}

void Crowd::join() {
  const LocalTime give_up = clock_.now() + kJoinWithin;
  std::size_t connected = 0;
  while (watching_ < viewers_.size() || !(plain_ || sync_.ready())) {
    if (clock_.now() > give_up) {
      throw std::runtime_error("after a minute " + std::to_string(welcomed_) +
                               " are welcomed and " + std::to_string(watching_) + " get frames");
    }
    while (connected < viewers_.size() && connected - welcomed_ < kUnderWay) {
      viewers_[connected] = std::make_unique<Viewer>();
      connect(*viewers_[connected++]);
    }
    wait(milliseconds(5));
    if (!plain_ && viewers_[0]->welcomed && !sync_.ready()) ping(*viewers_[0]);
    pingAll();
  }
}

void Crowd::begin() {
  passage_ = {};
  seen_.clear();
  counted_from_ = newest_ + 1;
  counting_ = true;
}

Passage Crowd::end() {
  const std::uint64_t last = newest_;
  const std::uint64_t bytes = passage_.bytes, got = passage_.delivered;
  receiveFor(kStragglers);
  counting_ = false;
  passage_.frames = last + 1 - counted_from_;
  passage_.expected = passage_.frames * viewers_.size();
  passage_.delivered = 0;
  for (const auto& [id, seen] : seen_) {
    if (id <= last) passage_.delivered += seen.viewers;
  }
  passage_.bytes = got > 0 ? bytes / got * passage_.delivered : 0;
  return passage_;
}

void Crowd::receiveFor(Duration time) {
  const LocalTime until = clock_.now() + time;
  for (LocalTime now = clock_.now(); now < until; now = clock_.now()) {
    wait(std::min<Duration>(until - now, milliseconds(20)));
    pingAll();
  }
}

void Crowd::wait(Duration at_most) {
  std::array<epoll_event, 256> events{};
  const auto timeout = std::chrono::ceil<milliseconds>(at_most).count();
  const int count = ::epoll_wait(epoll_, events.data(), events.size(), static_cast<int>(timeout));
  for (int i = 0; i < count; ++i)
    read(*static_cast<Viewer*>(events[static_cast<std::size_t>(i)].data.ptr));
}

void Crowd::pingAll() {
  if (plain_) return;
  // One after the other, each as often as it should: in a crowd nobody is in step.
  const LocalTime now = clock_.now();
  const auto most = static_cast<Duration::rep>(viewers_.size());
  for (int i = 0; i < kMostPings && next_ping_at_ <= now; ++i) {
    next_ping_at_ = std::max(next_ping_at_ + Duration(kPingEvery) / most, now - kPingEvery);
    const auto& viewer = viewers_[next_ping_++ % viewers_.size()];
    if (viewer && viewer->welcomed) ping(*viewer);
  }
}

void Crowd::ping(Viewer& viewer) { say(viewer.socket, Ping{clock_.now()}); }

void Crowd::read(Viewer& viewer) {
  for (;;) {
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
    if (size < 0 && errno != EAGAIN && errno != EINTR) fail("a connection has ended");
    if (size < 0) return;
    while (take(viewer)) {
    }
  }
}

bool Crowd::take(Viewer& viewer) {
  if (viewer.skip > 0) return false;
  if (viewer.small_bytes > 0) {
    if (viewer.small.size() < viewer.small_bytes) return false;
    message(viewer, std::span(viewer.small).subspan(kPrefixBytes));
    viewer.small.clear();
    viewer.small_bytes = 0;
  }
  if (viewer.held < kPrefixBytes) return false;
  std::uint32_t length = 0;
  std::memcpy(&length, viewer.head.data(), sizeof length);
  const std::size_t whole = kPrefixBytes + length;
  if (viewer.held < std::min(whole, kNeededBytes)) return false;
  const std::size_t here = std::min(viewer.held, whole);
  const std::span<const std::uint8_t> held(viewer.head.data(), here);
  if (frameHead(held.subspan(kPrefixBytes))) {
    frame(viewer, held.subspan(kPrefixBytes), length);
    viewer.skip = whole - here;
  } else {
    if (whole > kMostSmallBytes) throw std::runtime_error("a message that is no frame is too long");
    viewer.small.assign(held.begin(), held.end());
    viewer.small_bytes = whole;
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
  if (std::holds_alternative<Welcome>(decoded.value())) {
    viewer.welcomed = true;
    ++welcomed_;
  }
  const auto* const pong = std::get_if<Pong>(&decoded.value());
  if (pong != nullptr && &viewer == viewers_[0].get())
    sync_.add(pong->t0, pong->t1, pong->t2, clock_.now());
}

void Crowd::frame(Viewer& viewer, std::span<const std::uint8_t> head, std::size_t bytes) {
  const FrameHead frame = *frameHead(head);
  if (!viewer.watching) {
    viewer.watching = true;
    ++watching_;
  }
  newest_ = std::max(newest_, frame.id);
  if (!counting_ || frame.id < counted_from_) return;
  const LocalTime now = clock_.now();
  Seen& seen = seen_[frame.id];
  if (seen.viewers++ == 0) seen.first = now;
  ++passage_.delivered;
  passage_.bytes += bytes;
  passage_.spread.add((now - seen.first).count());
  const Duration media_now = now.time_since_epoch() + (plain_ ? Duration(0) : sync_.offset(now));
  passage_.latency.add(media_now.count() - frame.media_time_ns);
}

}  // namespace hapticast::testing
