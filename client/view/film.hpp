// SPDX-License-Identifier: MIT
// The view of --film. It writes a film of 1280 x 720 px at the video's rate. A separate thread
// draws and encodes.
// Thread: any (onPicture()), main (all others).
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/view/force_plot.hpp"
#include "client/view/picture.hpp"
#include "client/view/view.hpp"
#include "common/media/media_module.hpp"

namespace hapticast::client {

class FilmView final : public View {
 public:
  /// Largest number of drawings that wait for the encoder. If the queue is full, the film repeats
  /// its last drawing. The value is a choice: ten seconds.
  static constexpr std::size_t kMostWaiting = 256;

  /// Opens the media module, and starts the thread that writes `file`. Throws std::runtime_error
  /// (one line) if the module cannot be opened.
  explicit FilmView(std::string file);
  FilmView(const FilmView&) = delete;
  FilmView& operator=(const FilmView&) = delete;
  ~FilmView() override { stop(); }

  void onPicture(VideoFrame picture, const Workspace& workspace) override;
  void onReport(const TickReport& report) override;
  [[nodiscard]] bool update(UiState& ui_state) override;
  [[nodiscard]] bool isBusy() override;
  /// Waits until the film is complete. Throws like View::finish().
  void finish() override;

 private:
  /// One picture of the film, with the ticks since the picture before.
  struct Shot {
    std::vector<TickReport> ticks;  // the film shows the last one
    std::shared_ptr<const StreamPicture> picture;
    std::string caption;
    double fps = 0.0;
    int repeats = 1;
  };
  void pushShot(Shot shot);
  void stop();
  // In the film's thread:
  void run();
  void write(const Shot& shot);

  std::string file_;
  const MediaModule& media_;
  PictureBuffer pictures_;
  Shot next_;  // under construction
  UserControls user_;
  double fps_ = 0.0;
  double due_s_ = 0.0;  // time of the film until the next picture

  std::mutex mutex_;
  std::condition_variable something_waits_;
  std::deque<Shot> waiting_;  // guarded by mutex_
  bool over_ = false;         // guarded by mutex_
  std::string error_;         // guarded by mutex_; not empty: the film has failed

  // For the film's thread only:
  std::unique_ptr<FilmEncoder> encoder_;  // null before the first picture
  double top_N_ = 4.0;                    // end of the force axis; it only grows
  ForceHistory history_;
  std::thread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
