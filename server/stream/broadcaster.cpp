// SPDX-License-Identifier: MIT
#include "server/stream/broadcaster.hpp"

#include <spdlog/common.h>
#include <spdlog/spdlog.h>
#include <algorithm>
#include <utility>

namespace hapticast::server {

namespace {
constexpr auto kCheckEvery = std::chrono::milliseconds(50);
// Checks of a thousand viewers last a while.
constexpr auto kCheckViewersEvery = std::chrono::milliseconds(250);
constexpr auto kCountEvery = std::chrono::seconds(1);
constexpr const char* kStrangers = "connections that are not viewers";
}  // namespace

Broadcaster::Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
                         StreamDescription description, StreamSettings settings)
    : io_(io),
      clock_(clock),
      media_clock_(media_clock),
      description_(std::move(description)),
      settings_(settings),
      access_(settings.insecure),
      timer_(io),
      pending_(settings.max_pending),
      answers_(settings.max_answers),
      counted_(clock.now()) {
  asio::co_spawn(
      io_, [this] { return startTimer(); }, asio::detached);
}

template <class Visit>
void Broadcaster::onIo(Visit visit) {
  ++waiting_;
  asio::post(io_, [this, visit = std::move(visit)] {
    --waiting_;
    visit();
  });
}

template <class... What>
void Broadcaster::sendAll(const What&... what) {
  // Sending to all viewers lasts a while. Items published in the meantime only enter the queues,
  // where newer frames replace older ones; the last item sends. An overloaded server drops frames
  // and is never late.
  const bool last = waiting_ == 0;
  for (const auto& viewer : viewers_) {
    if (last) {
      viewer->send(what...);
    } else {
      viewer->queue(what...);
    }
  }
  // The last viewer receives some milliseconds later, so the order rotates.
  if (last && !viewers_.empty())
    std::rotate(viewers_.begin(), viewers_.begin() + 1, viewers_.end());
}

void Broadcaster::publish(EncodedFrame frame) {
  onIo([this, frame = std::move(frame)] {
    if (isTooLarge(frame)) return sendAll();  // only flushes the queues
    const std::uint64_t dropped = stale_.dropped();
    const auto next = stale_.push(frame, media_clock_.now(), description_.pipeline_latency,
                                  fromSeconds(1.0 / description_.fps));
    if (stale_.dropped() != dropped) {
      for (const auto& viewer : viewers_) viewer->requireKeyFrame();
    }
    if (next) return send(*next);
    sendAll();
  });
}

void Broadcaster::send(const EncodedFrame& frame) {
  ++counts_.frames;
  counts_.delay = media_clock_.now() - frame.media_time;
  counts_.published_at = clock_.now();
  last_frame_ = frame;
  preparing_ = nullptr;
  // Datagrams first: one costs a fraction of a send by TCP, and most viewers use them.
  if (datagrams_ != nullptr) datagrams_->send(frame);
  sendAll(frame);
}

void Broadcaster::publish(EncodedVideo video) {
  onIo([this, video = std::move(video)] {
    last_video_ = video;
    sendAll(video);
  });
}

void Broadcaster::prepare(double share) {
  onIo([this, share] {
    preparing_ = encodeShared(Preparing{share});
    sendAll(preparing_);
  });
}

void Broadcaster::describe(const StreamDescription& description) {
  onIo([this, description] {
    if (description == description_) return sendAll();  // only flushes the queues
    const bool other_picture = !(description.workspace == description_.workspace);
    description_ = description;
    if (other_picture) {
      last_frame_.reset();
      last_video_.reset();
      stale_.reset();
    }
    const SharedBytes payload = encodeShared(description_);
    sendAll(payload, other_picture);
  });
}

void Broadcaster::changeKey(const DatagramKey& key) {
  onIo([this, key] {
    const bool sealed = identity_ && identity_->sealed;
    if (sealed) identity_->datagram_key = key;
    const SharedBytes payload = encodeShared(key);
    for (const auto& viewer : viewers_) {
      if (sealed && viewer->datagramToken() != 0) viewer->queue(payload);
    }
    sendAll();  // flushes the queues of all viewers: a frame before may wait for that
  });
}

void Broadcaster::changeOrigin(StreamIdentity identity, const StreamDescription& description,
                               std::function<void()> change_clock) {
  onIo([this, identity = std::move(identity), description, change = std::move(change_clock)] {
    if (change) change();
    identity_ = identity;
    description_ = description;
    preparing_ = nullptr;
    last_frame_.reset();
    last_video_.reset();
    stale_.reset();
    if (datagrams_ != nullptr) datagrams_->changeOrigin(identity);
    for (const auto& viewer : viewers_) viewer->welcomeAgain();
  });
}

void Broadcaster::stop() {
  asio::post(io_, [this] {
    stopped_ = true;
    // close() and abort() change the lists.
    const Sessions pending = pending_.all(), viewers = viewers_, answers = answers_.all();
    for (const Sessions* each : {&pending, &viewers}) {
      for (const auto& session : *each) session->close(serverEnds());
    }
    for (const auto& session : answers) session->abort();
    timer_.cancel();
    if (datagrams_ != nullptr) datagrams_->stop();
  });
}

void Broadcaster::setAccess(AccessList list) {
  onIo([this, list = std::move(list)] {
    access_.set(list);
    checkAccess();
  });
}

void Broadcaster::checkAccess() {
  bool removed = false;
  const Sessions all(viewers_.begin(), viewers_.end());  // close() changes the list
  for (const auto& session : all) {
    if (access_.permits(session->grant())) continue;
    session->close({ErrorCode::kUnauthorized, "your access token is no longer valid"});
    removed = true;
  }
  if (removed && on_removed_) on_removed_();
}

std::optional<WireError> Broadcaster::control(const Control& request,
                                              const std::shared_ptr<Session>& sender) {
  Control control = request;
  control.viewers.reset();  // clients set none of these
  control.operator_name.clear();
  control.at.reset();
  if (streams_ != nullptr) {
    if (control.material != Material{})
      return WireError{ErrorCode::kForbidden, "a viewer may pause, seek and set the speed only"};
    streams_->onControl(*sender, control);
    confirm(*sender, control);
    return std::nullopt;
  }
  if (control == Control{}) {  // asks for the number of viewers, which only an operator gets
    confirm(*sender, control);
    return std::nullopt;
  }
  const auto& grant = sender->grant();
  if (!grant) return WireError{ErrorCode::kForbidden, "this server has no operators (--tokens)"};
  if (grant->role != Role::kOperator)
    return WireError{ErrorCode::kForbidden, "this access token is a viewer's, not an operator's"};
  if (!control_)
    return WireError{ErrorCode::kForbidden, "this server is an edge; control its origin"};
  control_(control, [this, control, name = sender->name(), weak = std::weak_ptr(sender)] {
    asio::post(io_, [this, control, name, weak] {
      if (const auto session = weak.lock()) confirm(*session, control);
      Control act = control;
      act.operator_name = name;
      act.at = media_clock_.now();
      acts_.add(weak, act);
    });
  });
  return std::nullopt;
}

void Broadcaster::confirm(Session& sender, Control control) const {
  const bool is_operator = sender.grant() && sender.grant()->role == Role::kOperator;
  if (is_operator) control.viewers = static_cast<std::uint32_t>(viewers_.size());
  sender.confirm(control);
}

std::optional<WireError> Broadcaster::refuse(const Hello& hello, const Channel& channel) const {
  if (hello.protocol_version != kProtocolVersion) {
    return WireError{ErrorCode::kVersion, "this server has protocol version " +
                                              std::to_string(kProtocolVersion) + ", the client " +
                                              std::to_string(hello.protocol_version)};
  }
  if (auto refusal = access_.refuse(hello.access_token, channel)) return refusal;
  if (viewers_.size() < settings_.max_clients) return std::nullopt;
  return WireError{ErrorCode::kServerFull,
                   "all " + std::to_string(settings_.max_clients) + " places are taken"};
}

void Broadcaster::completeWelcome(const Channel& channel, Welcome& welcome) {
  if (identity_) {
    welcome.stream = identity_->stream;
    welcome.verifying_key = identity_->verifying_key;
  }
  if (channel.carrier() == Carrier::kWebSocket) return;  // a browser has no datagrams
  const bool sealed = identity_ && identity_->sealed;
  // A viewer that cannot open datagrams receives none.
  if (datagrams_ == nullptr || (sealed && !(identity_->datagram_key && channel.encrypted())))
    return;
  datagrams_->offer(channel.hosts(), welcome);
  if (sealed && welcome.datagram_token != 0) welcome.datagram_key = identity_->datagram_key;
}

void Broadcaster::deliver(std::uint64_t datagram_token, const Delivery& delivery) {
  if (datagrams_ != nullptr) datagrams_->setDelivery(datagram_token, delivery);
  countViewers();  // it may want pictures from now on, or none
}

void Broadcaster::onJoined(Session& session) {
  const auto self = session.shared_from_this();
  pending_.remove(self);
  viewers_.push_back(self);
  ++counts_.welcomed;
  countViewers();
  if (preparing_) session.queue(preparing_);  // onJoined()'s caller flushes the queue
  if (last_frame_) session.queue(*last_frame_);
  if (last_video_) session.queue(*last_video_);
  if (session.wantsActs() && acts_.newest()) session.queue(acts_.newest());
  if (streams_ != nullptr) streams_->onJoined(self);
  log(spdlog::level::info, session.label() + " joined");
}

void Broadcaster::onClosing(const std::shared_ptr<Session>& session,
                            const std::optional<WireError>& why) {
  const bool was_viewer = std::erase(viewers_, session) > 0;
  pending_.remove(session);
  countViewers();
  if (was_viewer && streams_ != nullptr) streams_->onLeft(*session);
  if (datagrams_ != nullptr) datagrams_->removeViewer(session->datagramToken());
  addWithin(pending_, session, kStrangers);
  if (!why) {
    if (was_viewer) log(spdlog::level::info, session->label() + " left");
  } else if (why->code != ErrorCode::kShuttingDown) {
    ++(why->code == ErrorCode::kTimeout ? counts_.timed_out : counts_.refused);
    log(spdlog::level::warn, "closing " + session->label() + ": " + why->message);
  }
}

void Broadcaster::onClosed(const std::shared_ptr<Session>& session) {
  if (!pending_.remove(session) && !answers_.remove(session)) return;
  counts_.sent += session->counts();
  counts_.bytes += session->bytesSent();
  if (stopped_ && connections() == 0) timer_.cancel();
}

void Broadcaster::countViewers() {
  const auto viewers = std::count_if(viewers_.begin(), viewers_.end(),
                                     [](const auto& each) { return each->isVideoSubscriber(); });
  video_viewers_.store(static_cast<std::size_t>(viewers), std::memory_order_relaxed);
  viewer_count_.store(viewers_.size(), std::memory_order_relaxed);
}

StreamCounts Broadcaster::counts() const {
  StreamCounts counts = counts_;
  counts.frames_stale = stale_.dropped();
  counts.clients = viewers_.size();
  counts.websockets = static_cast<std::size_t>(std::count_if(
      viewers_.begin(), viewers_.end(), [](const auto& each) { return each->ofWebSocket(); }));
  for (const Sessions* each : {&pending_.all(), &answers_.all(), &std::as_const(viewers_)}) {
    for (const auto& session : *each) {
      counts.sent += session->counts();
      counts.bytes += session->bytesSent();
    }
  }
  return counts;
}

void Broadcaster::check(const Sessions& sessions, LocalTime now) {
  const Sessions all(sessions.begin(), sessions.end());  // a check may close a session
  for (const auto& session : all) session->check(now);
}

asio::awaitable<void> Broadcaster::startTimer() {
  while (!stopped_ || connections() > 0) {
    boost::system::error_code ec;
    timer_.expires_after(kCheckEvery);
    co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    if (const auto late = stale_.poll(media_clock_.now())) send(*late);
    const LocalTime now = clock_.now();
    check(pending_.all(), now);
    if (now - checked_ >= kCheckViewersEvery) {
      checked_ = now;
      check(viewers_, now);
      check(answers_.all(), now);
    }
    if (now - counted_ < kCountEvery) continue;
    counted_ = now;
    checkAccess();  // tokens expire
    acts_.sendTo(viewers_);
    if (datagrams_ != nullptr) datagrams_->check(now);
    log_.logStaleFrames(stale_.dropped(), now);
    log_.logSlowViewers(counts(), now);
    if (datagrams_ != nullptr) log_.logDatagrams(datagrams_->counts(), now);
    log_.logHidden(now, stopped_);
  }
  log_.logHidden(clock_.now(), true);
}

bool Broadcaster::isTooLarge(const EncodedFrame& frame) {
  const bool too_large = frame.delta->size() > kMaxMessageBytes;
  if (too_large || frame.too_many_datagrams)
    log_.logLargeFrame(frame.delta->size(), too_large, clock_.now());
  return too_large;
}

void Broadcaster::accept(std::unique_ptr<Channel> channel) {
  const auto session = std::make_shared<Session>(
      io_, std::move(channel), static_cast<SessionHost&>(*this), ++last_session_id_);
  session->start();
  addWithin(pending_, session, kStrangers);
  if (stopped_) session->close(serverEnds());
}

void Broadcaster::addWithin(LimitedSessions& list, const std::shared_ptr<Session>& session,
                            std::string_view what) {
  const std::shared_ptr<Session> peer = list.add(session);
  if (peer == nullptr || stopped_) return;  // at shutdown all receive a goodbye
  ++counts_.refused;
  log(spdlog::level::warn, fmt::format("too many {}: closing {}", what, peer->label()));
  peer->abort();
}

void Broadcaster::onRequest(const std::shared_ptr<Session>& session, const std::string& problem) {
  pending_.remove(session);
  if (!problem.empty()) {
    ++counts_.refused;
    log(spdlog::level::warn, fmt::format("closing {}: {}", session->label(), problem));
  }
  addWithin(answers_, session, "requests at once");
}

void Broadcaster::logStatus() const {
  spdlog::info("status: {} viewers, {} frames, delay {:.1f} ms", viewers_.size(), counts_.frames,
               1e3 * toSeconds(counts_.delay));
}

}  // namespace hapticast::server
