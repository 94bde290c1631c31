// SPDX-License-Identifier: MIT
// Receives a haptic video from hapticast-server or from a Publisher.
//
// Contract
// - Bounded memory. A Stream keeps at most `max_waiting` frames that the caller has not read. It
//   drops the oldest one for each further frame, and counts it.
// - Trust. The bytes of a server are checked before use. With TLS the server is authenticated as
//   hapticast-client does it: by a certificate authority, or by the key of the first connection
//   (file hapticast/known_servers in $XDG_STATE_HOME or ~/.local/state). Another key is an error.
// - Threads. A Stream has a network thread, and with play() one that prepares frames. One thread of
//   the caller calls next(). Any thread may call all other functions.
// - Signals. The library handles none.
// - fork(). A Stream belongs to the process that made it. In a child next(), play() and close()
//   throw std::runtime_error.
// - Errors and units: frame.hpp. A Stream that was moved from must not be used.
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

/// Choices of a connection.
struct StreamSettings {
  std::string token = {};        ///< access token of the server's operator; empty: none
  bool tls = false;              ///< true: use TLS. hapticasts://HOST uses TLS in any case
  std::string tls_ca_file = {};  ///< PEM file of certificate authorities; empty: trust on first use
  bool insecure = false;         ///< true: the token may travel without TLS
  bool udp = false;              ///< true: frames by UDP where the server offers it, else by TCP
  /// True: a frame waits for its picture, at most until four later frames have arrived. Then
  /// Frame::jpeg is empty.
  bool pictures = false;
  /// True: after a loss the Stream tries to connect again, without end. next() then waits for the
  /// next frame, as long as its timeout permits. A first connection that fails is an error in any
  /// case.
  bool reconnect = false;
  bool thesis = false;             ///< the value of RendererSettings::thesis, for play()
  std::size_t max_waiting = 64;    ///< frames, 1..1024
  double connect_timeout_s = 5.0;  ///< limit of each step of the connection, above 0, at most 3600
  std::string name = "libhapticast";  ///< name of this program for the server, at most 64 bytes
};

/// A connection to a server.
class Stream {
 public:
  /// Connects to `address` and waits for the welcome. `address` is HOST, HOST:PORT,
  /// hapticasts://HOST[:PORT] or mdns:NAME (the name that a server announces). The default port is
  /// 7447. Errors: std::invalid_argument (address, settings), std::runtime_error (no answer, a
  /// server of another version, a refusal, a wrong key).
  explicit Stream(const std::string& address, const StreamSettings& settings = {});
  ~Stream();
  Stream(Stream&& from) noexcept;
  Stream& operator=(Stream&& from) noexcept;

  /// Returns the properties of the stream, as the server has stated them last.
  [[nodiscard]] StreamInfo info() const;
  /// Returns the next frame. Waits for it at most `timeout_s` (negative: without a limit). Returns
  /// nullopt after the timeout, at the end of the stream, and after close(). ended() is false only
  /// after a timeout. Frames that wait come before the end or the error. Errors: std::runtime_error
  /// (the connection was lost; every further call throws it again).
  [[nodiscard]] std::optional<Frame> next(double timeout_s = -1.0);
  /// Plays the stream with `renderer` from now on, as hapticast-client does: the time of its ticks
  /// is now(), and its playout delay follows the jitter. next() returns the frames as well, and
  /// counts unread ones as dropped. Stream and renderer may end or move in any order. Errors:
  /// std::invalid_argument (the renderer has had begin(), a tick or another player; the Stream
  /// plays already; or RendererSettings::thesis differs from StreamSettings::thesis).
  void play(Renderer& renderer);
  /// Returns the time for the ticks of a Renderer that plays a Stream, s of the steady clock.
  [[nodiscard]] static double now();

  /// Returns true while the server is connected.
  [[nodiscard]] bool connected() const;
  /// Returns true if next() has no more frames: after the end of the stream, an error or close().
  [[nodiscard]] bool ended() const;
  /// Returns the number of frames that the Stream dropped because the caller did not read them.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Ends the connection. A next() that waits returns. A second call does nothing.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Plays messages of the wire (proto/README.md) with a renderer, in the caller's time. With the
/// same messages, times and positions the forces have the same bits as those of hapticast-client.
/// Thread: that of the ticks.
class MessagePlayer {
 public:
  /// Player and renderer may end in any order, and the renderer may move. Errors:
  /// std::invalid_argument (the renderer has had begin(), a tick or another player).
  explicit MessagePlayer(Renderer& renderer);
  ~MessagePlayer();
  MessagePlayer(const MessagePlayer&) = delete;
  MessagePlayer& operator=(const MessagePlayer&) = delete;

  /// Adds one message of a server. The first one is a welcome. Give each message without its length
  /// prefix. `arrival_s` is the time of its arrival on the clock of the ticks, s. An arrival before
  /// the last one counts as at the time of the last one. Errors: std::runtime_error (the message is
  /// damaged or out of place; the connection counts as lost, as in the client, and the next message
  /// has to be a welcome), std::invalid_argument (a time that is not finite).
  void push(std::span<const std::uint8_t> message, double arrival_s);
  /// Passes the frames that are due at `time_s` to the renderer. Call it before each tick, with the
  /// time of the tick. Errors: std::invalid_argument (a time that is not finite).
  void release(double time_s);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
