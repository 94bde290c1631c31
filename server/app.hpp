// SPDX-License-Identifier: MIT
// The server as wiring: source -> vision on the calling thread, frames to bytes on a second one
// (EncoderThread), the network on a third.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "common/time.hpp"
#include "common/wire/asio.hpp"
#include "server/encoder_thread.hpp"
#include "server/plan_teller.hpp"
#include "server/range_teller.hpp"
#include "server/settings.hpp"
#include "server/source/pacer.hpp"
#include "server/stream/announce.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/datagram_signer.hpp"
#include "server/stream/listener.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

class App {
 public:
  /// Opens the source and the port. Throws SourceError or std::runtime_error, one line each.
  /// `clock` outlives the app.
  App(Settings settings, const Clock& clock);

  /// Streams until the clip ends (without --loop), --frames are shown, or stop(). Throws
  /// SourceError when the source breaks on the way. Thread: the pipeline's; call once.
  void run();
  /// Ends run() soon. Thread: any, also a signal handler.
  void stop() noexcept { stop_ = true; }
  /// Whether frames have begun to go out: what fails later is no wrong input.
  [[nodiscard]] bool streaming() const { return streaming_; }

 private:
  /// What sends the stream by UDP.
  struct Datagrams {
    Datagrams(asio::io_context& io, const Clock& clock, const Listener& listener,
              const Settings& settings);
    DatagramSigner signer;
    std::optional<MulticastGroup> group;
    DatagramSender sender;
  };

  void look();
  /// Lets viewers in, once: not before the source has shown that there is nothing to complain of.
  void open();
  void waitForViewer() const;
  void play(EncoderThread& encoder);
  [[nodiscard]] std::optional<RgbdFrame> nextFrame(Pacer& pacer);
  void publish(VisionResult result, EncoderThread& encoder);
  void sayWhatWasSkipped(const Pacer& pacer);
  void waitUntil(MediaTime due) const;

  Settings settings_;
  LocalMediaClock media_clock_;
  std::unique_ptr<RgbdSource> source_;
  Vision vision_;
  asio::io_context io_;
  Broadcaster broadcaster_;
  Listener listener_;
  std::optional<Datagrams> datagrams_;
  std::optional<Announcer> announcer_;  // once it is open
  PlanTeller plan_teller_;
  RangeTeller range_teller_;
  std::atomic<bool> stop_{false};
  bool open_ = false;
  bool streaming_ = false;
  MediaTime last_published_{};
  std::uint64_t told_skipped_ = 0;
  MediaTime told_at_{};
};

}  // namespace hapticast::server
