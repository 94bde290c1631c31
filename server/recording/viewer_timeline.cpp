// SPDX-License-Identifier: MIT
#include "server/recording/viewer_timeline.hpp"

#include <utility>
#include <variant>

namespace hapticast::server {

namespace {
// A wait without a time ends by a request.
constexpr Duration kForEver = std::chrono::hours(24);
}  // namespace

ViewerTimeline::ViewerTimeline(const Server& server, RecordingPlayer player,
                               const std::shared_ptr<Session>& viewer)
    : server_(server),
      player_(std::move(player), server.name),
      viewer_(viewer),
      timer_(server.io) {}

void ViewerTimeline::request(const Control& control) {
  if (control.paused) request_.paused = control.paused;
  if (control.seek_s) request_.seek_s = control.seek_s;
  if (control.speed) request_.speed = control.speed;
  if (waits_for_requests_) timer_.cancel();
}

void ViewerTimeline::stop() {
  stopped_ = true;
  timer_.cancel();
}

asio::awaitable<void> ViewerTimeline::play() {
  const auto self = shared_from_this();
  co_await asio::post(server_.io, asio::use_awaitable);  // the welcome comes first
  while (!stopped_) {
    const auto viewer = viewer_.lock();
    if (!viewer) co_return;
    if (player_.carryOut(std::exchange(request_, Control{}))) {
      co_await waitFor(kSeekPause, false);
      continue;  // the next request may be there
    }
    if (player_.rests()) {
      describe(*viewer);
      co_await waitFor(kForEver, true);
      continue;
    }
    const MediaTime now = server_.media_clock.now();
    const auto due = player_.prepare(now);
    if (!due) {
      player_.stopAtEnd();
    } else if (*due > now) {
      co_await waitFor(*due - now, true);
    } else {
      publish(*viewer, player_.take());
      co_await asio::post(server_.io, asio::use_awaitable);  // other viewers have their turn
    }
  }
}

asio::awaitable<void> ViewerTimeline::waitFor(Duration time, bool for_requests) {
  if (stopped_) co_return;
  waits_for_requests_ = for_requests;
  boost::system::error_code cancelled;
  timer_.expires_after(time);
  co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
}

void ViewerTimeline::publish(Session& viewer, RecordedItem item) {
  if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    describe(viewer);
    const EncodedFrame encoded = encoder_.encode(std::move(*frame), &server_.signer, false);
    viewer.send(encoded);
  } else if (auto* const picture = std::get_if<VideoFrame>(&item)) {
    if (viewer.isVideoSubscriber()) viewer.send(encodeVideo(std::move(*picture)));
  }
}

void ViewerTimeline::describe(Session& viewer) {
  const Workspace before = player_.description().workspace;
  if (!player_.updateDescription(server_.media_clock.now())) return;
  const bool other_picture = !(player_.description().workspace == before);
  viewer.queue(encodeShared(player_.description()), other_picture);
  viewer.flush();
}

void ViewerTimelines::onJoined(const std::shared_ptr<Session>& viewer) {
  auto reader = recording_.reopen();
  if (!reader.ok())
    return viewer->close({ErrorCode::kServerFull, "the recording " + reader.error().message});
  auto timeline = std::make_shared<ViewerTimeline>(
      server_, RecordingPlayer(std::move(reader).value(), loop_), viewer);
  timelines_[viewer.get()] = timeline;
  asio::co_spawn(
      server_.io, [timeline] { return timeline->play(); }, asio::detached);
}

void ViewerTimelines::onLeft(const Session& viewer) {
  const auto found = timelines_.find(&viewer);
  if (found == timelines_.end()) return;
  found->second->stop();
  timelines_.erase(found);
}

void ViewerTimelines::onControl(const Session& viewer, const Control& control) {
  if (const auto found = timelines_.find(&viewer); found != timelines_.end())
    found->second->request(control);
}

}  // namespace hapticast::server
