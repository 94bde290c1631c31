// SPDX-License-Identifier: MIT
#include "client/include/hapticast/stream.hpp"

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "client/library/haptics/renderer_impl.hpp"
#include "client/library/receive/frame_inbox.hpp"
#include "client/library/receive/frame_reader.hpp"
#include "client/net/connection.hpp"
#include "client/net/decode_thread.hpp"
#include "client/net/receiver.hpp"
#include "client/servers/server_trust.hpp"
#include "common/library/require.hpp"
#include "common/mdns.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

/// Returns the server that `address` names.
client::ServerSettings importServer(const std::string& address, const StreamSettings& from) {
  client::ServerSettings to;
  require(client::parseServer(address, to),
          "address: '" + address + "' is not HOST, HOST:PORT, hapticasts://HOST or mdns:NAME");
  to.tls = to.tls || from.tls;
  to.tls_ca_file = from.tls_ca_file;
  return to;
}

client::ConnectionSettings importSettings(const std::string& address, const StreamSettings& from) {
  require(from.max_waiting >= 1 && from.max_waiting <= 1024, "max_waiting: outside 1..1024");
  require(from.connect_timeout_s > 0.0 && from.connect_timeout_s <= 3600.0,
          "connect_timeout_s: outside 0..3600 s");
  require(from.token.size() <= limits::kAccessToken, "token: more than 256 bytes");
  require(from.name.size() <= limits::kClientName, "name: more than 64 bytes");
  const client::ServerSettings settings = importServer(address, from);
  client::ConnectionSettings to;
  to.server = settings.server;
  to.dial = client::chooseDial(settings, client::nameServer(settings));
  to.delivery.best = from.udp ? client::Transport::kDatagrams : client::Transport::kTcp;
  to.client_name = from.name;
  to.access_token = from.token;
  to.insecure = from.insecure;
  to.wants_video = from.pictures;
  to.connect_deadline = fromSeconds(from.connect_timeout_s);
  return to;
}

}  // namespace

class Stream::Impl {
 public:
  Impl(const std::string& address, const StreamSettings& settings);
  ~Impl() { close(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void requireOwner() const {
    if (::getpid() != owner_) throw std::runtime_error("the stream belongs to the parent process");
  }
  [[nodiscard]] bool isOwner() const { return ::getpid() == owner_; }
  void waitForWelcome();
  void play(Renderer::Impl& renderer);
  void close();
  [[nodiscard]] StreamInfo info() const {
    const std::lock_guard lock(mutex_);
    return info_;
  }
  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] client::FrameInbox& inbox() { return inbox_; }

 private:
  [[nodiscard]] client::ConnectionEvents events();
  void run();
  void onWelcome(const StreamDescription& description);
  void onDisconnected(const std::string& why);
  /// Ends the stream. `error` is one line, or empty for an end without an error.
  void end(const std::string& error);

  const pid_t owner_ = ::getpid();
  const std::string address_;
  const bool reconnects_;
  const Method method_;
  SteadyClock clock_;
  asio::io_context io_;
  client::FrameInbox inbox_;
  client::FrameReader reader_;  // network thread
  bool goodbye_ = false;        // network thread
  std::shared_ptr<FrameFeed> feed_ = std::make_shared<FrameFeed>();
  client::DecodeThread decode_thread_;  // started by play()
  bool playing_ = false;
  client::Receiver receiver_;
  client::Connection connection_;
  std::atomic<bool> connected_{false};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool welcomed_ = false;  // guarded by mutex_
  StreamInfo info_;        // guarded by mutex_
  std::mutex close_mutex_;
  std::jthread network_;  // last member: it uses everything above
};

Stream::Impl::Impl(const std::string& address, const StreamSettings& settings)
    : address_(address),
      reconnects_(settings.reconnect),
      method_(settings.thesis ? Method::kThesis : Method::kHapticast),
      inbox_(settings.max_waiting, settings.pictures),
      decode_thread_(feed_->pool, clock_, method_,
                     [this](const client::PreparedFrame& frame) {
                       asio::post(io_, [this, frame] { receiver_.addPrepared(frame); });
                     }),
      receiver_(decode_thread_, feed_->timing, settings.thesis ? 2 : 1),
      connection_(io_, clock_, importSettings(address, settings), receiver_, events()) {
  receiver_.onFrame([this](const client::AssembledFrame& assembled) {
    inbox_.push(reader_.read(assembled, receiver_.stream().workspace));
  });
  connection_.start();
  network_ = std::jthread([this] { run(); });
}

void Stream::Impl::run() {
  try {
    io_.run();
  } catch (const std::exception& error) {  // such as std::bad_alloc
    end(error.what());
  }
}

client::ConnectionEvents Stream::Impl::events() {
  client::ConnectionEvents events;
  events.welcomed =
      events.described = [this](const StreamDescription& description) { onWelcome(description); };
  events.video = [this](VideoFrame video) { inbox_.push(std::move(video)); };
  events.goodbye = [this] { goodbye_ = true; };
  events.disconnected = [this](const std::string& why) { onDisconnected(why); };
  events.failed = [this](const std::string& why) { end(address_ + ": " + why); };
  return events;
}

void Stream::Impl::onWelcome(const StreamDescription& description) {
  const std::lock_guard lock(mutex_);
  info_ = exportInfo(description);
  welcomed_ = true;
  connected_ = true;
  goodbye_ = false;
  changed_.notify_all();
}

void Stream::Impl::onDisconnected(const std::string& why) {
  connected_ = false;
  const bool was_welcomed = [this] {
    const std::lock_guard lock(mutex_);
    return welcomed_;
  }();
  if (reconnects_ && was_welcomed) return;
  end(goodbye_ && was_welcomed ? "" : address_ + ": " + why);
}

void Stream::Impl::end(const std::string& error) {
  connected_ = false;
  inbox_.end(error);
  connection_.stop();
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

void Stream::Impl::waitForWelcome() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return welcomed_ || inbox_.ended(); });
  lock.unlock();
  if (inbox_.ended()) (void)inbox_.pop(0.0);  // throws the error
}

void Stream::Impl::play(Renderer::Impl& renderer) {
  if (renderer.method() != method_)
    throw std::invalid_argument("thesis: the settings of stream and renderer differ");
  if (playing_) throw std::invalid_argument("the stream plays with a renderer already");
  renderer.attach(feed_);
  playing_ = true;
  decode_thread_.start();
}

void Stream::Impl::close() {
  const std::lock_guard lock(close_mutex_);
  decode_thread_.stop();
  connection_.stop();
  if (network_.joinable()) network_.join();
  connected_ = false;
  inbox_.end("");
}

Stream::Stream(const std::string& address, const StreamSettings& settings)
    : impl_(std::make_unique<Impl>(address, settings)) {
  impl_->waitForWelcome();
}

Stream::~Stream() {
  // A child process has no network thread that could be joined.
  if (impl_ && !impl_->isOwner()) (void)impl_.release();
}
Stream::Stream(Stream&& from) noexcept = default;
Stream& Stream::operator=(Stream&& from) noexcept {
  Stream old(std::move(*this));
  impl_ = std::move(from.impl_);
  return *this;
}

StreamInfo Stream::info() const { return impl_->info(); }

std::optional<Frame> Stream::next(double timeout_s) {
  impl_->requireOwner();
  if (std::isnan(timeout_s)) throw std::invalid_argument("timeout_s: is not a number");
  return impl_->inbox().pop(timeout_s);
}

void Stream::play(Renderer& renderer) {
  impl_->requireOwner();
  impl_->play(*renderer.impl_);
}

double Stream::now() { return toSeconds(SteadyClock().now()); }

bool Stream::connected() const { return impl_->connected(); }

bool Stream::ended() const { return impl_->inbox().ended(); }

std::uint64_t Stream::dropped() const { return impl_->inbox().dropped(); }

void Stream::close() {
  impl_->requireOwner();
  impl_->close();
}

}  // namespace hapticast
