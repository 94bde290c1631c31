// SPDX-License-Identifier: MIT
#include "server/recording/viewer_timeline.hpp"

#include <algorithm>
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
      player_(std::move(player)),
      viewer_(viewer),
      timer_(server.io),
      recorded_(player_.reader().description()),
      sent_(describeBegin(player_, server.name)) {}

StreamDescription ViewerTimeline::describeBegin(const RecordingPlayer& player,
                                                const std::string& name) {
  StreamDescription description = describePlayback(player.reader().description(), 1.0, name);
  description.timeline = player.timeline();
  description.timeline->position_s = 0.0;
  return description;
}

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
    if (carryOut()) {
      co_await waitFor(kSeekPause, false);
      continue;  // the next request may be there
    }
    if (paused_ || at_end_) {
      describe(*viewer);
      co_await waitFor(kForEver, true);
      continue;
    }
    const MediaTime now = server_.media_clock.now();
    const auto due = player_.prepare(now);
    if (!due) {
      at_end_ = true;
    } else if (*due > now) {
      co_await waitFor(*due - now, true);
    } else {
      publish(*viewer, player_.take());
      co_await asio::post(server_.io, asio::use_awaitable);  // other viewers have their turn
    }
  }
}

bool ViewerTimeline::carryOut() {
  const Control request = std::exchange(request_, Control{});
  if (request.paused) {
    if (paused_ && !*request.paused) player_.resume();
    paused_ = *request.paused;
  }
  if (request.speed) player_.setSpeed(*request.speed);
  if (!request.seek_s) return false;
  player_.seek(*request.seek_s);
  place_s_ = *request.seek_s;
  at_end_ = false;
  return true;
}

asio::awaitable<void> ViewerTimeline::waitFor(Duration time, bool for_requests) {
  if (stopped_) co_return;
  waits_for_requests_ = for_requests;
  boost::system::error_code cancelled;
  timer_.expires_after(time);
  co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
}

void ViewerTimeline::publish(Session& viewer, RecordedItem item) {
  if (auto* const description = std::get_if<StreamDescription>(&item)) {
    recorded_ = std::move(*description);
  } else if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    place_s_ = player_.timeline().computePosition_s(frame->media_time);
    describe(viewer);
    const EncodedFrame encoded = encoder_.encode(std::move(*frame), &server_.signer, false);
    viewer.send(encoded);
  } else if (viewer.isVideoSubscriber()) {
    viewer.send(encodeVideo(std::move(std::get<VideoFrame>(item))));
  }
}

void ViewerTimeline::describe(Session& viewer) {
  StreamDescription description = describePlayback(recorded_, player_.speed(), server_.name);
  Timeline timeline = player_.timeline();
  if (paused_ || at_end_) {
    timeline.position_s =
        std::clamp(at_end_ ? timeline.length_s : place_s_, 0.0, timeline.length_s);
    timeline.at = sent_.timeline->speed == 0.0 ? sent_.timeline->at : server_.media_clock.now();
    timeline.speed = 0.0;
  }
  description.timeline = timeline;
  if (description == sent_) return;
  const bool other_picture = !(description.workspace == sent_.workspace);
  sent_ = std::move(description);
  viewer.queue(encodeShared(sent_), other_picture);
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
