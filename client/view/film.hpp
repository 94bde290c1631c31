// SPDX-License-Identifier: MIT
// The view of --film: what happens, drawn as the screenshot is and written as it goes on, at the
// video's rate. Drawing and encoding have a thread of their own, which this view ends.
// Thread: takePicture() any, everything else main.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <string>
#include <thread>
#include <vector>

#include "client/view/force_history.hpp"
#include "client/view/picture_buffer.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class FilmView final : public View {
 public:
  /// Drawings that wait, at most: beyond, the one before is shown for longer. Chosen: ten seconds.
  static constexpr std::size_t kMostWaiting = 256;

  /// Throws std::runtime_error unless `file` ends as a film does (.mp4).
  explicit FilmView(std::string file);
  FilmView(const FilmView&) = delete;
  FilmView& operator=(const FilmView&) = delete;
  ~FilmView() override { stop(); }

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onReport(const TickReport& report) override;
  [[nodiscard]] bool update(UiState& ui_state) override;
  /// Waits until all is written.
  void finish() override;

 private:
  /// A picture of the film: what is drawn, and the ticks since the one before.
  struct Shot {
    std::vector<TickReport> ticks;  // the last of them is shown
    std::shared_ptr<const StreamPicture> picture;
    double fps = 0.0;
    int repeats = 1;
  };
  void pushShot(Shot shot);
  void stop();
  // On the film's thread:
  void run();
  void write(const Shot& shot);
  void open(const cv::Mat& drawing, double fps);

  std::string file_;
  PictureBuffer pictures_;
  Shot next_;  // grows
  double fps_ = 0.0;
  double due_s_ = 0.0;  // of film time, until the next shot

  std::mutex mutex_;
  std::condition_variable something_waits_;
  std::deque<Shot> waiting_;   // guarded by mutex_
  bool over_ = false;          // guarded by mutex_
  std::exception_ptr failed_;  // of the film's thread; after it has ended main's

  // The film's thread alone:
  cv::VideoWriter writer_;
  cv::Size size_;
  ForceHistory history_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::client
