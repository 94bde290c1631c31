// SPDX-License-Identifier: MIT
// Publishes a haptic video of your own: a server for hapticast-client, Stream and the web page.
//
// Contract
// - Frames. Each frame goes to all viewers. A slow viewer loses old frames and does not delay the
//   others.
// - Time. A frame has the time of its publish() call, unless the argument `time_s` gives another
//   one. Times have to rise. The impacts of a frame keep their distance to Frame::time_s, which has
//   no other effect.
// - Heights are rounded to 0.02 mm on the wire.
// - Threads. publish() and close() have one thread; all other functions may be called by any
//   thread. A Publisher has a network thread of its own, which receives no signals.
// - fork(). A Publisher belongs to the process that made it. In a child every function but the
//   destructor throws std::runtime_error. The child keeps the port open until it ends.
// - Log. News and warnings go to the default logger of spdlog, which belongs to the program:
//   spdlog::set_level(spdlog::level::off) silences it, spdlog::set_default_logger() replaces it.
// - Errors, units and axes: frame.hpp.
//
// Example: a disc that moves up and down. makeDisc() makes the heights of the example of frame.hpp,
// at another z. The velocity states how they move until the next frame.
//
//   hapticast::Publisher publisher({.info = {.name = "disc"}});
//   for (int i = 0; i < 250; ++i) {
//     const double z_mm = 20.0 + 5.0 * std::sin(0.1 * i);
//     hapticast::Object& disc = frame.objects.at(0);
//     disc.heights = makeDisc(z_mm);
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

/// Choices of a server.
struct PublisherSettings {
  StreamInfo info = {};
  /// Address for viewers: HOST:PORT, PORT, or [ADDRESS]:PORT. Port 0 selects a free one.
  std::string listen = "[::]:7447";
  bool udp = true;                 ///< true: viewers may receive frames by UDP
  std::string tls_cert_file = {};  ///< PEM file of the certificate; empty: no TLS
  std::string tls_key_file = {};   ///< PEM file of its key; name both files or none
  /// File of access tokens, as --tokens of hapticast-server (server/stream/README.md has its
  /// lines). Empty: everybody may connect. With tokens and without TLS, the Publisher refuses
  /// viewers on other machines.
  std::string tokens_file = {};
  std::size_t max_viewers = 64;  ///< 1..10000; each needs an open file (RLIMIT_NOFILE)
};

/// A server of one haptic video.
class Publisher {
 public:
  /// Opens the port and accepts viewers. Errors: std::invalid_argument (a setting outside its
  /// range, an address that is not of this machine), std::runtime_error (the port is in use, a file
  /// cannot be read).
  explicit Publisher(const PublisherSettings& settings = {});
  ~Publisher();
  Publisher(Publisher&& from) noexcept;
  Publisher& operator=(Publisher&& from) noexcept;

  /// Sends `frame` to all viewers, and its picture to those that want pictures. The Publisher
  /// numbers the frames, so Frame::id is ignored. `time_s` is the time of the capture on the clock
  /// of now(), s. A negative value stands for the present time. Call it at most 0.25 s after the
  /// capture plus StreamInfo::latency_s: viewers may miss a frame that comes later. An object with
  /// the HeightMap of the frame before costs no heights on the wire. An object without heights is
  /// not sent. Returns the time of the frame, s. Errors: std::invalid_argument (a value outside its
  /// range, sizes that do not match, a time that does not rise or is more than 1 s after now();
  /// nothing is sent), std::runtime_error (after close()).
  double publish(const Frame& frame, double time_s = -1.0);
  /// Returns the present time on the clock of the frames, s. The clock begins at 0 in the
  /// constructor.
  [[nodiscard]] double now() const;
  /// Returns the port at which viewers connect.
  [[nodiscard]] std::uint16_t port() const;
  /// Returns the number of viewers that are connected.
  [[nodiscard]] std::size_t viewers() const;
  /// Sends a goodbye to all viewers and closes the port. Lasts at most about 1 s. A second call
  /// does nothing. The destructor calls it, too.
  void close();

 private:
  class Impl;
  [[nodiscard]] Impl& impl() const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
