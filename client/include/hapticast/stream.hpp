// SPDX-License-Identifier: MIT
// Receives a haptic video from hapticast-server or from a Publisher.
//
// Contract
// - Bounded memory. A Stream keeps at most `most_waiting` frames that the caller has not read. It
//   drops the oldest one for each further frame, and counts it.
// - Trust. The bytes of a server are checked before use. With TLS the server is authenticated as
//   hapticast-client does it: by a certificate authority, or by the key of the first connection.
// - Threads. A Stream has a network thread of its own. next() has one thread. close(), dropped()
//   and connected() may be called by any thread.
// - fork(). A Stream belongs to the process that made it.
//
// Example: print the objects of a stream.
//
//   hapticast::Stream stream("localhost:7447");
//   while (const auto frame = stream.next())
//     for (const auto& object : frame->objects)
//       std::printf("%.3f s: object %u at z %.1f mm\n", frame->time_s, object.id,
//                   object.position_mm.z());
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hapticast/frame.hpp"
#include "hapticast/renderer.hpp"

namespace hapticast {

struct StreamSettings {
  std::string token = {};        ///< access token; empty: none
  bool tls = false;              ///< true: as an address hapticasts://HOST
  std::string tls_ca_file = {};  ///< certificate authorities; empty: trust on first use
  bool thesis = false;           ///< true: play() with a renderer that has RendererSettings::thesis
  bool insecure = false;         ///< true: the token may travel without TLS
  bool udp = false;              ///< true: frames by UDP where the server offers it
  bool pictures = false;         ///< true: frames have a picture, and arrive when it has arrived
  bool reconnect = false;        ///< true: next() waits for a new connection after a loss
  std::size_t most_waiting = 64;      ///< frames, 1..1024
  double connect_timeout_s = 5.0;     ///< of each step of the connection, > 0
  std::string name = "libhapticast";  ///< name of this program for the server, at most 64 bytes
};

/// A connection to a server.
class Stream {
 public:
  /// Connects to `address`: HOST, HOST:PORT, hapticasts://HOST:PORT or mdns:NAME. Waits for the
  /// welcome.
  /// Errors: std::invalid_argument (address, settings), std::runtime_error (no answer, a server of
  /// another version, a refusal).
  explicit Stream(const std::string& address, const StreamSettings& settings = {});
  ~Stream();
  Stream(Stream&& from) noexcept;
  Stream& operator=(Stream&& from) noexcept;

  /// Returns the properties of the stream, as the server has stated them last. Thread: any.
  [[nodiscard]] StreamInfo info() const;
  /// Returns the next frame. Waits for it, at most `timeout_s` (negative: without a limit). Returns
  /// nullopt after the timeout, at the end of the stream, and after close(). Errors:
  /// std::runtime_error (the connection was lost).
  [[nodiscard]] std::optional<Frame> next(double timeout_s = -1.0);
  /// Plays the stream with `renderer` from now on, as hapticast-client does: the time of its ticks
  /// is now(), and its playout delay follows the jitter. next() goes on as well. Call it once.
  /// Errors: std::invalid_argument (the renderer has had ticks or frames, or another method).
  void play(Renderer& renderer);
  /// Returns the time for the ticks of a Renderer that plays a Stream, s. Thread: any.
  [[nodiscard]] static double now();

  [[nodiscard]] bool connected() const;
  /// Returns true after the end of the stream, and after close().
  [[nodiscard]] bool ended() const;
  /// Returns the number of frames that were dropped because nobody read them.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Ends the connection. A next() that waits returns. A second call does nothing.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Plays messages of the wire (proto/README.md) with a renderer, in the caller's time. With the
/// same messages, times and positions its forces have the same bits as those of hapticast-client.
/// Thread: that of the ticks.
class MessagePlayer {
 public:
  /// Errors: std::invalid_argument (the renderer has had ticks or frames).
  explicit MessagePlayer(Renderer& renderer);
  ~MessagePlayer();
  MessagePlayer(const MessagePlayer&) = delete;
  MessagePlayer& operator=(const MessagePlayer&) = delete;

  /// Adds a message without its length prefix that arrived at `arrival_s`. Times must not
  /// decrease. Errors: std::runtime_error (the message is damaged or out of place; the connection
  /// then counts as lost, as in the client).
  void push(std::span<const std::uint8_t> message, double arrival_s);
  /// Passes the frames that are due at `time_s` to the renderer. Call it before each tick.
  void release(double time_s);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
