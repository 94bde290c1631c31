// SPDX-License-Identifier: MIT
#include "client/view/film.hpp"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "client/view/picture.hpp"
#include "client/view/status.hpp"
#include "client/view/touch_picture.hpp"
#include "common/media/load_media_module.hpp"

namespace hapticast::client {

namespace {

// A larger step of play time in a tick is a jump.
constexpr double kJump_s = 0.05;

/// Returns the film time of this tick: the step of play time; for a pause or a jump the step of
/// local time.
double computeElapsed_s(const TickReport& before, const TickReport& now) {
  const double play_s = toSeconds(now.play_time - before.play_time);
  return play_s > 0.0 && play_s < kJump_s ? play_s : toSeconds(now.time - before.time);
}

/// Opens the media module for the film `file`. Throws like FilmView's constructor.
const MediaModule& loadModule(const std::string& file) {
  try {
    return loadMediaModule();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("--film " + file + ": " + error.what());
  }
}

}  // namespace

FilmView::FilmView(std::string file) : file_(std::move(file)), media_(loadModule(file_)) {
  thread_ = std::thread([this] { run(); });
}

void FilmView::onPicture(VideoFrame picture, const Workspace& workspace) {
  pictures_.add(std::move(picture), workspace);
}

void FilmView::onReport(const TickReport& report) {
  if (!next_.ticks.empty()) due_s_ -= computeElapsed_s(next_.ticks.back(), report);
  next_.ticks.push_back(report);
  if (due_s_ > 0.0) return;
  if (fps_ > 0.0) next_.picture = pictures_.findNearest(report.play_time);
  if (!next_.picture) {  // the film begins with the first picture
    next_.ticks = {report};
    return;
  }
  next_.fps = fps_;
  next_.caption = touchLine(report, user_);
  due_s_ = std::max(due_s_ + 1.0 / fps_, 0.0);
  Shot shot = std::exchange(next_, {});
  next_.ticks.push_back(shot.ticks.back());  // the next shot begins with the last tick
  pushShot(std::move(shot));
}

void FilmView::pushShot(Shot shot) {
  {
    const std::lock_guard lock(mutex_);
    if (!error_.empty()) return;
    if (waiting_.size() < kMostWaiting) {
      waiting_.push_back(std::move(shot));
    } else {
      ++waiting_.back().repeats;
    }
  }
  something_waits_.notify_one();
}

bool FilmView::update(UiState& ui_state) {
  user_ = ui_state.user;
  if (ui_state.stream.connected) fps_ = ui_state.stream.fps;
  return true;
}

bool FilmView::isBusy() {
  const std::lock_guard lock(mutex_);
  return error_.empty() && waiting_.size() > kMostWaiting / 2;
}

void FilmView::finish() {
  stop();
  if (!error_.empty()) throw std::runtime_error("--film " + error_);
  if (!encoder_)
    throw std::runtime_error("--film " + file_ + ": no picture arrived, so the film is empty");
}

void FilmView::stop() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  something_waits_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void FilmView::run() {
  // For this thread and the encoder's threads: loop and window have priority.
  (void)!::nice(5);
  try {
    while (true) {
      Shot shot;
      {
        std::unique_lock lock(mutex_);
        something_waits_.wait(lock, [this] { return over_ || !waiting_.empty(); });
        if (waiting_.empty()) break;
        shot = std::move(waiting_.front());
        waiting_.pop_front();
      }
      write(shot);
    }
    if (encoder_) encoder_->close();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    error_ = error.what();
  }
}

void FilmView::write(const Shot& shot) {
  // The first tick is the last one of the shot before.
  for (std::size_t i = 1; i < shot.ticks.size(); ++i) history_.add(shot.ticks[i]);
  const Workspace& workspace = shot.picture->workspace;
  const cv::Mat picture =
      decodeJpeg(shot.picture->video.jpeg, {workspace.width_px, workspace.height_px});
  for (const TickReport& report : shot.ticks) {
    while (report.force_N.norm() > top_N_) top_N_ *= 2.0;
  }
  const cv::Mat plot = drawRecentPlot(history_, top_N_, "N", kForceCurves, kTouchPlot_px);
  const cv::Mat drawing =
      drawTouchPicture(picture, shot.ticks.back(), workspace, shot.caption, plot);
  if (!encoder_) encoder_ = media_.openFilm(file_, {drawing.cols, drawing.rows, shot.fps});
  for (int i = 0; i < shot.repeats; ++i) encoder_->write(viewPixels(drawing));
}

}  // namespace hapticast::client
