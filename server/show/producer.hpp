// SPDX-License-Identifier: MIT
// Interface of what makes the stream of a show: a clip, a recording, an origin, a bake. Show calls
// connect(), prepare(), start(), step() again and again, finish() and release().
// Thread: the one of Show::run(), if a function states no other.
#pragma once

#include "common/protocol/messages.hpp"
#include "common/time.hpp"
#include "server/http/metrics.hpp"
#include "server/pipeline/operated_stream.hpp"

namespace hapticast::server {

class Show;

/// The maker of one stream.
class Producer {
 public:
  virtual ~Producer() = default;

  /// Returns the clock of the stream, which lives as long as the producer. Null: the stream has no
  /// viewers and no time, because the producer writes a file.
  [[nodiscard]] virtual const MediaClock* mediaClock() const { return nullptr; }
  /// Returns the present description of the stream.
  [[nodiscard]] virtual StreamDescription description() const { return {}; }
  /// Connects the stream with the sinks of `show`, which is valid until release(). Throws
  /// std::runtime_error with one line. An override calls this function, too.
  virtual void connect(Show& show) { show_ = &show; }
  /// Returns what operators change; null: they may change nothing. Valid from connect() to
  /// release().
  [[nodiscard]] virtual OperatedStream* operated() { return nullptr; }
  /// Prepares the stream until the first viewer may join, or until the show stops: scans a clip,
  /// waits for an origin. Throws SourceError.
  virtual void prepare() {}
  /// Begins the stream, and logs what it plays.
  virtual void start() = 0;
  /// Makes the next part of the stream when it is due. Returns false at the end. Throws
  /// SourceError.
  virtual bool step() = 0;
  /// Completes the stream after its end or after Show::stop(), also one that was not started. Waits
  /// until viewers have played it. Returns whether it is complete; a stream for viewers always is.
  /// Throws std::runtime_error with one line.
  virtual bool finish() { return true; }
  /// Frees everything that uses the show, also after an exception. The network thread has ended.
  virtual void release() noexcept {}
  /// Adds figures for operators. Thread: the network's, from connect() to release().
  virtual void addTo(Metrics& /*metrics*/) const {}

 protected:
  Show* show_ = nullptr;  // from connect() on
};

}  // namespace hapticast::server
