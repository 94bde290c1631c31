// SPDX-License-Identifier: MIT
// Publishes a haptic video of your own: a server for hapticast-client, Stream and the web page.
//
// Contract
// - Frames. Each frame goes to all viewers. A slow viewer loses old frames and delays nobody.
// - Time. A frame has the time of its publish() unless it states its own. Times have to rise.
// - Heights are rounded to 0.02 mm on the wire.
// - Threads. publish() and close() have one thread. A Publisher has a network thread of its own,
//   which receives no signals.
// - fork(). A Publisher belongs to the process that made it. In a child every function but the
//   destructor throws std::runtime_error. The child keeps the port open until it ends.
// - Log. News and warnings go to the default logger of spdlog, which belongs to the program:
//   spdlog::set_level(spdlog::level::off) silences it, spdlog::set_default_logger() replaces it.
//
// Example: a disc that moves up and down. Its heights are new in each frame; the velocity states
// viewers how they change until the next one.
//
//   hapticast::Publisher publisher({.info = {.name = "disc"}});
//   for (int i = 0; i < 250; ++i) {
//     const double z_mm = 5.0 * std::sin(0.1 * i);
//     hapticast::Object& disc = frame.objects[0];
//     disc.heights = makeDisc(20.0 + z_mm);
//     disc.position_mm.z() = z_mm;
//     disc.velocity_mm_s.z() = 12.5 * std::cos(0.1 * i);
//     publisher.publish(frame);
//     std::this_thread::sleep_for(std::chrono::milliseconds(40));
//   }
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "hapticast/frame.hpp"

namespace hapticast {

struct PublisherSettings {
  StreamInfo info = {};
  /// Address for viewers: HOST:PORT, PORT, or [ADDRESS]:PORT; port 0: a free one.
  std::string listen = "[::]:7447";
  bool udp = true;                 ///< true: viewers may receive datagrams
  std::string tls_cert_file = {};  ///< PEM files of certificate and key; empty: no TLS
  std::string tls_key_file = {};
  /// Access tokens, as --tokens of hapticast-server; empty: none. Without TLS only viewers of this
  /// machine can connect then.
  std::string tokens_file = {};
  std::size_t most_viewers = 64;  ///< 1..10000; each needs an open file (RLIMIT_NOFILE)
};

class Publisher {
 public:
  /// Opens the port and accepts viewers. Errors: std::invalid_argument, std::runtime_error.
  explicit Publisher(const PublisherSettings& settings = {});
  ~Publisher();
  Publisher(Publisher&& from) noexcept;
  Publisher& operator=(Publisher&& from) noexcept;

  /// Sends `frame` to all viewers, and its picture to those that want pictures. Its id and its
  /// time are ignored: frames are numbered here, and `time_s` states the time of the capture on the
  /// clock of now(). `time_s` < 0: the present time. Publish a frame within 0.25 s of its time plus
  /// StreamInfo::latency_s: a newer frame may replace a later one. Objects whose heights are the
  /// same HeightMap as in the frame before are sent without heights. Objects without heights are
  /// not sent. Returns the time of the frame. Errors: std::invalid_argument (a value outside its
  /// range, sizes that do not match, a time that does not rise or is more than 1 s after now();
  /// nothing is sent), std::runtime_error (after close()).
  double publish(const Frame& frame, double time_s = -1.0);
  /// Returns the present time of the frames, s. Thread: any.
  [[nodiscard]] double now() const;
  /// Returns the actual port. Thread: any.
  [[nodiscard]] std::uint16_t port() const;
  /// Returns the number of viewers that are connected. Thread: any.
  [[nodiscard]] std::size_t viewers() const;
  /// Sends a goodbye to all viewers and closes the port. It lasts at most about 1 s. A second call
  /// does nothing. The destructor closes, too.
  void close();

 private:
  class Impl;
  [[nodiscard]] Impl& impl() const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
