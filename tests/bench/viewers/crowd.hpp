// SPDX-License-Identifier: MIT
// Many viewers in one thread, at little cost of their own: they look at the head of a frame and
// throw the rest away. Thread: one.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/histogram.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/clock_sync.hpp"
#include "common/transport/datagram.hpp"
#include "tests/bench/viewers/dialect.hpp"

namespace hapticast::testing {

struct FrameHead {
  std::uint64_t id = 0;
  std::int64_t media_time_ns = 0;
};
/// The first fields of a Message that holds a HapticFrame (proto/hapticast.proto); nullopt: it
/// holds something else.
[[nodiscard]] std::optional<FrameHead> frameHead(std::span<const std::uint8_t> payload);

/// The data that a crowd received.
struct Passage {
  std::uint64_t delivered = 0;  ///< whole frames, over all viewers
  std::uint64_t expected = 0;
  std::uint64_t bytes = 0;   ///< of the payloads of frames
  std::uint64_t frames = 0;  ///< that were published
  Histogram latency;         ///< arrival - media time
  Histogram spread;          ///< behind the first viewer to get that frame
};

class Crowd {
 public:
  Crowd(const sockaddr_in& server, std::size_t viewers, Transport way);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// Until all are welcomed, get frames and know the clock. Throws std::runtime_error.
  void join();
  /// Counts the frames that are newer than any that has come, up to `last`.
  void begin();
  void end(std::uint64_t last);
  /// The newest frame that anybody has got.
  [[nodiscard]] std::uint64_t newest() const { return newest_; }
  /// Whether everybody has got all frames up to the newest.
  [[nodiscard]] bool complete() const {
    return delivered_ == (newest_ + 1 - counted_from_) * viewers_.size();
  }
  /// Of all that was counted.
  [[nodiscard]] const Passage& passage() const { return passage_; }

  /// The same, and begins anew.
  Passage takePassage() { return std::exchange(passage_, {}); }

  /// Reads what comes.
  void wait(Duration at_most);
  void pingAll();

 private:
  struct Viewer;
  struct Seen {
    LocalTime first;
    std::uint64_t viewers = 0;
  };
  void connect(Viewer& viewer);
  void ping(Viewer& viewer);
  void openDatagrams(Viewer& viewer, const sockaddr_in& to);
  void askForDatagrams(Viewer& viewer, const Welcome& welcome);
  void echo(Viewer& viewer);
  void readDatagrams(Viewer& viewer);
  void datagram(Viewer& viewer, const DatagramHeader& header);
  void read(Viewer& viewer);
  /// Takes the message at the front of what the viewer holds; false: more of it is needed.
  bool take(Viewer& viewer);
  void message(Viewer& viewer, std::span<const std::uint8_t> payload);
  void frame(Viewer& viewer, std::uint64_t id, Duration media_time, std::size_t bytes);

  SteadyClock clock_;
  sockaddr_in server_;
  Transport way_;
  int epoll_ = -1;
  std::vector<std::unique_ptr<Viewer>> viewers_;
  std::size_t welcomed_ = 0;
  std::size_t watching_ = 0;  // have had a frame
  ClockSync sync_;            // by the first viewer's pings
  LocalTime next_ping_at_;
  std::size_t next_ping_ = 0;  // whose turn it is
  std::uint64_t newest_ = 0;
  bool counting_ = false;
  std::uint64_t counted_from_ = 0;
  std::map<std::uint64_t, Seen> seen_;
  std::uint64_t delivered_ = 0;  // of those that are counted now
  Passage passage_;
};

/// Lets all of them receive for so long, or until `done`.
void receiveFor(std::span<Crowd* const> crowds, Duration time,
                const std::function<bool()>& done = nullptr);

}  // namespace hapticast::testing
