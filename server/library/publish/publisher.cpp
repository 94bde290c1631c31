// SPDX-License-Identifier: MIT
#include "server/include/hapticast/publisher.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "common/endpoint.hpp"
#include "common/library/frame_import.hpp"
#include "common/library/require.hpp"
#include "common/text.hpp"
#include "common/transport/asio.hpp"
#include "common/wire_limits.hpp"
#include "server/library/member_names.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/frame_signer.hpp"
#include "server/stream/key_file.hpp"
#include "server/stream/limited_log.hpp"
#include "server/stream/listener.hpp"
#include "server/stream/server_tls.hpp"

namespace hapticast {

namespace {

constexpr double kMostAhead_s = 1.0;  // chosen: farther ahead the time is of another clock
constexpr std::size_t kMostViewers = 10'000;

Endpoint parseListen(const std::string& text) {
  const auto endpoint = parseEndpoint(text, {"::", kDefaultPort});
  require(endpoint.has_value(),
          "listen: " + quote(text) + " is no address; use HOST:PORT, PORT or [ADDRESS]:PORT");
  return *endpoint;
}

server::TlsFiles findTlsFiles(const PublisherSettings& settings) {
  require(settings.tls_cert_file.empty() == settings.tls_key_file.empty(),
          "tls_cert_file, tls_key_file: TLS needs both files; name both or none");
  return {settings.tls_cert_file, settings.tls_key_file, false};
}

server::StreamSettings makeStreamSettings(const PublisherSettings& settings) {
  require(settings.max_viewers >= 1 && settings.max_viewers <= kMostViewers,
          "max_viewers: " + std::to_string(settings.max_viewers) + " is outside 1..10000");
  const bool tls = findTlsFiles(settings).wanted();
  return {.max_clients = settings.max_viewers,
          .max_pending =
              tls ? server::Broadcaster::kMaxPendingHandshakes : server::Broadcaster::kMaxPending};
}

void requirePicture(const std::vector<std::uint8_t>& jpeg) {
  if (jpeg.empty()) return;
  require(jpeg.size() <= limits::kJpeg,
          "jpeg: " + std::to_string(jpeg.size()) + " bytes are more than 4 MiB");
  require(jpeg.size() >= 2 && jpeg[0] == 0xFF && jpeg[1] == 0xD8,
          "jpeg: does not begin with FF D8; encode the picture as a JPEG");
}

/// Returns whether no pixel belongs to the object. The wire has no such object.
bool hasNoSurface(const HapticObject& object) {
  const auto belongs = [](std::uint8_t mask) { return mask != 0; };
  return object.relief == nullptr ||
         std::none_of(object.relief->mask.begin(), object.relief->mask.end(), belongs);
}

/// Starts a thread that receives no signals: they belong to the threads of the program.
template <class Run>
std::jthread startWithoutSignals(Run run) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const auto restore = [&before] { pthread_sigmask(SIG_SETMASK, &before, nullptr); };
  try {
    std::jthread thread(std::move(run));
    restore();
    return thread;
  } catch (...) {
    restore();
    throw;
  }
}

}  // namespace

class Publisher::Impl {
 public:
  explicit Impl(const PublisherSettings& settings);
  ~Impl() { close(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  double publish(const Frame& frame, double time_s);
  void close();
  [[nodiscard]] double now() const { return toSeconds(media_clock_.now()); }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::size_t viewers() const { return broadcaster_.viewers(); }
  /// Returns whether this process made the object. A child has no network thread.
  [[nodiscard]] bool isOwn() const { return ::getpid() == maker_; }

 private:
  /// Returns the time of the next frame. `time_s` < 0: the present time.
  [[nodiscard]] MediaTime chooseTime(double time_s) const;
  void send(const HapticFrame& frame, const std::vector<std::uint8_t>& jpeg);

  pid_t maker_ = ::getpid();
  SteadyClock clock_;
  LocalMediaClock media_clock_{clock_};
  FrameImporter importer_;
  server::FrameSigner signer_;  // outlives all encoded frames
  server::LimitedLog secrets_log_{clock_};
  asio::io_context io_;
  server::Broadcaster broadcaster_;
  server::Listener listener_;
  std::optional<server::DatagramSender> datagrams_;
  server::FrameEncoder encoder_;
  std::uint16_t port_;
  std::uint64_t next_id_ = 1;
  std::optional<MediaTime> last_time_;
  bool closed_ = false;
  std::jthread network_;  // last member: it runs io_
};

Publisher::Impl::Impl(const PublisherSettings& settings)
    : importer_(settings.info),
      signer_(SigningKey(), findTlsFiles(settings).wanted()
                                ? std::make_unique<server::DatagramSealer>(clock_)
                                : nullptr),
      broadcaster_(io_, clock_, media_clock_, importer_.description(),
                   makeStreamSettings(settings)),
      listener_(io_, parseListen(settings.listen), broadcaster_,
                server::loadServerTls(findTlsFiles(settings), secrets_log_)),
      port_(listener_.address().port) {
  broadcaster_.introduce(signer_.identity());
  if (!settings.tokens_file.empty())
    broadcaster_.setAccess(server::loadAccessList(settings.tokens_file, secrets_log_));
  broadcaster_.onRemoved([this] { signer_.revokeKey(); });
  if (settings.udp) {
    datagrams_.emplace(io_, clock_, listener_.endpoint(), signer_.identity());
    broadcaster_.enableUdp(*datagrams_);
  }
  listener_.start();
  network_ = startWithoutSignals([this] { io_.run(); });
}

MediaTime Publisher::Impl::chooseTime(double time_s) const {
  const MediaTime now = media_clock_.now();
  MediaTime time = now;
  if (!(time_s < 0.0)) {
    require(time_s <= toSeconds(now) + kMostAhead_s,
            "time_s: " + std::to_string(time_s) + " s is more than 1 s after the present time, " +
                std::to_string(toSeconds(now)) + " s; use the clock of now()");
    time = mediaTime(time_s);
  }
  require(!last_time_ || time > *last_time_,
          "time_s: " + std::to_string(toSeconds(time)) + " s does not rise; the frame before had " +
              std::to_string(last_time_ ? toSeconds(*last_time_) : 0.0) + " s");
  return time;
}

double Publisher::Impl::publish(const Frame& frame, double time_s) {
  if (closed_) throw std::runtime_error("publish: the Publisher is closed; make another one");
  requirePicture(frame.jpeg);
  const MediaTime time = chooseTime(time_s);
  HapticFrame made = importer_.import(frame, next_id_, time);
  ++next_id_;
  last_time_ = time;
  std::erase_if(made.objects, hasNoSurface);
  send(made, frame.jpeg);
  return toSeconds(time);
}

void Publisher::Impl::send(const HapticFrame& frame, const std::vector<std::uint8_t>& jpeg) {
  server::rotateKey(signer_, {&broadcaster_});
  broadcaster_.publish(encoder_.encode(frame, {}, &signer_, broadcaster_.datagramsWanted()));
  if (jpeg.empty() || !broadcaster_.videoWanted()) return;
  broadcaster_.publish(server::encodeVideo({frame.epoch, frame.id, frame.media_time, jpeg}));
}

void Publisher::Impl::close() {
  if (std::exchange(closed_, true)) return;
  listener_.stop();
  broadcaster_.stop();
  network_.join();
}

Publisher::Publisher(const PublisherSettings& settings) try
    : impl_(std::make_unique<Impl>(settings)) {
} catch (const AddressError& error) {
  throw std::invalid_argument(nameMembers(error.what()));
} catch (const std::runtime_error& error) {
  throw std::runtime_error(nameMembers(error.what()));
}

Publisher::~Publisher() {
  // In a child process the thread to join does not exist.
  if (impl_ && !impl_->isOwn()) (void)impl_.release();
}

Publisher::Publisher(Publisher&& from) noexcept = default;

Publisher& Publisher::operator=(Publisher&& from) noexcept {
  Publisher old(std::move(from));
  impl_.swap(old.impl_);
  return *this;
}

Publisher::Impl& Publisher::impl() const {
  if (!impl_) throw std::runtime_error("the Publisher was moved from; use the one it moved to");
  if (!impl_->isOwn())
    throw std::runtime_error(
        "the Publisher belongs to the process before fork(); make one in this process");
  return *impl_;
}

double Publisher::publish(const Frame& frame, double time_s) {
  return impl().publish(frame, time_s);
}
double Publisher::now() const { return impl().now(); }
std::uint16_t Publisher::port() const { return impl().port(); }
std::size_t Publisher::viewers() const { return impl().viewers(); }
void Publisher::close() { impl().close(); }

}  // namespace hapticast
