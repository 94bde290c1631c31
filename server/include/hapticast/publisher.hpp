// SPDX-License-Identifier: MIT
// Publishes a haptic video of your own: a server for hapticast-client, Stream and the web page.
//
// Contract
// - Frames. Each frame goes to all viewers. A slow viewer loses old frames and delays nobody.
// - Time. A frame has the time of its publish() unless it states its own. Times have to rise.
// - Heights are rounded to 0.02 mm on the wire.
// - Threads. publish() has one thread. A Publisher has a network thread of its own.
// - fork(). A Publisher belongs to the process that made it.
//
// Example: publish a disc that moves up and down.
//
//   hapticast::Publisher publisher({.info = {.name = "disc"}});
//   for (int i = 0; i < 250; ++i) {
//     frame.objects[0].position_mm.z() = 5.0 * std::sin(0.1 * i);
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
  StreamInfo info;
  /// Address for viewers: HOST:PORT, PORT, or [ADDRESS]:PORT; port 0: a free one.
  std::string listen = "[::]:7447";
  bool udp = true;            ///< true: viewers may receive datagrams
  std::string tls_cert_file;  ///< PEM files of certificate and key; empty: no TLS
  std::string tls_key_file;
  std::string tokens_file;  ///< access tokens, as --tokens of hapticast-server; empty: none
  std::size_t most_viewers = 64;
};

class Publisher {
 public:
  /// Opens the port and accepts viewers. Errors: std::invalid_argument, std::runtime_error.
  explicit Publisher(const PublisherSettings& settings = {});
  ~Publisher();
  Publisher(Publisher&& from) noexcept;
  Publisher& operator=(Publisher&& from) noexcept;

  /// Sends `frame` to all viewers. Its id is ignored: frames are numbered here. `time_s` < 0: the
  /// present time. Objects whose heights are the same HeightMap as in the frame before are sent
  /// without heights. Returns the time of the frame. Errors: std::invalid_argument (a value outside
  /// its range, sizes that do not match, a time that does not rise; nothing is sent),
  /// std::runtime_error (after close()).
  double publish(const Frame& frame, double time_s = -1.0);
  /// Returns the present time of the frames, s. Thread: any.
  [[nodiscard]] double now() const;
  /// Returns the actual port. Thread: any.
  [[nodiscard]] std::uint16_t port() const;
  /// Returns the number of viewers that are connected. Thread: any.
  [[nodiscard]] std::size_t viewers() const;
  /// Sends a goodbye to all viewers and closes the port. A second call does nothing.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
