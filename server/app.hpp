// SPDX-License-Identifier: MIT
// The server as wiring: source -> vision on the calling thread, frames to bytes on a second one,
// the network on a third.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "common/time.hpp"
#include "common/wire/asio.hpp"
#include "server/settings.hpp"
#include "server/source/pacer.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/listener.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

class App {
 public:
  /// Opens the source and the port. Throws SourceError or std::runtime_error, one line each.
  App(Settings settings, const Clock& clock);

  /// Streams until the clip ends (without --loop), --frames are shown, or stop(). Throws
  /// SourceError when the source breaks on the way. Thread: the pipeline's; call once.
  void run();
  /// Ends run() soon. Thread: any, also a signal handler.
  void stop() noexcept { stop_ = true; }
  /// Whether frames have begun to go out: what fails later is no wrong input.
  [[nodiscard]] bool streaming() const { return last_published_ != MediaTime{}; }
  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }

 private:
  void scan();
  void play();
  [[nodiscard]] std::optional<RgbdFrame> nextFrame(Pacer& pacer);
  struct Outgoing {
    StreamDescription description;
    VisionResult result;
  };
  /// Hands a frame to the encoder's thread.
  void publish(VisionResult result);
  void encodeAll();
  void encode(const Outgoing& next);
  void explain();
  void sayWhatWasSkipped(const Pacer& pacer);
  void waitUntil(MediaTime due) const;

  Settings settings_;
  MediaClock media_clock_;
  std::unique_ptr<RgbdSource> source_;
  Vision vision_;
  asio::io_context io_;
  Broadcaster broadcaster_;
  Listener listener_;
  FrameEncoder encoder_;
  StreamDescription announced_;  // by the encoder's thread, once it runs
  std::mutex outgoing_mutex_;
  std::condition_variable outgoing_changed_;
  std::deque<Outgoing> outgoing_;  // under the mutex
  bool ended_ = false;             // under the mutex
  std::exception_ptr failure_;     // of the encoder's thread; under the mutex
  std::atomic<bool> stop_{false};
  MediaTime last_published_{};
  std::uint64_t told_skipped_ = 0;
  MediaTime told_at_{};
  struct ToldPlan {
    std::vector<PlanLine> lines;
    MediaTime at;
  };
  std::map<std::uint32_t, ToldPlan> told_plans_;  // by object id
};

}  // namespace hapticast::server
