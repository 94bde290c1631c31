// SPDX-License-Identifier: MIT
// Many viewers in one thread, at little cost of their own: they look at the head of a frame and
// throw the rest away. Thread: one.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/histogram.hpp"
#include "common/wire/clock_sync.hpp"
#include "common/wire/datagram.hpp"
#include "common/wire/messages.hpp"

namespace hapticast::testing {

/// What a crowd has got.
struct Passage {
  std::uint64_t delivered = 0;  ///< whole frames, over all viewers
  std::uint64_t expected = 0;
  std::uint64_t bytes = 0;  ///< of the payloads of frames
  Duration time{0};
  std::uint64_t frames = 0;  ///< that were published in that time
  Histogram latency;         ///< arrival - media time
  Histogram spread;          ///< behind the first viewer to get that frame
};

enum class Way {
  kPlain,  ///< by TCP, unasked, with this machine's steady clock as their media time
  kTcp,
  kUdp,
};

class Crowd {
 public:
  Crowd(const sockaddr_in& server, std::size_t viewers, Way way);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// Until all are welcomed, get frames and know the clock. Throws std::runtime_error.
  void join();
  /// Counts for so long; `begun` and `ended` are called around that, before the stragglers.
  template <class Begun, class Ended>
  Passage run(Duration time, const Begun& begun, const Ended& ended) {
    begin();
    begun();
    const LocalTime from = clock_.now();
    receiveFor(time);
    ended();
    passage_.time = clock_.now() - from;
    return end();
  }

 private:
  struct Viewer;
  struct Seen {
    LocalTime first;
    std::uint64_t viewers = 0;
  };
  void connect(Viewer& viewer);
  void begin();
  Passage end();
  void receiveFor(Duration time);
  void wait(Duration at_most);
  void pingAll();
  void ping(Viewer& viewer);
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
  Way way_;
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
  Passage passage_;
};

}  // namespace hapticast::testing
