// SPDX-License-Identifier: MIT
// Writes what a page needs to render a recording: messages with their arrivals, and positions of a
// device; and the force that the client's own renderer computes for them
// (hapticast::MessagePlayer). force_test.py passes the same to the core of the page. The hand
// slides over the object and presses. The arrivals have jitter.
//   hapticast-force-script RECORDING.mcap OUT SECONDS SEED
//
// OUT is little-endian. Its records are: 1, arrival (double, ms), size (uint32), bytes; or 2, time
// (double, ms), position (3 doubles, device mm), force (3 doubles, N).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client/device/pointed_hand.hpp"
#include "client/include/hapticast/renderer.hpp"
#include "client/include/hapticast/stream.hpp"
#include "client/net/client_session.hpp"
#include "client/web/recorded_server.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::testing {
namespace {

using client::RecordedServer;

struct Arrival {
  double time_ms;
  std::vector<std::uint8_t> bytes;
};

class Script {
 public:
  Script(const std::string& recording, const std::string& out, unsigned seed)
      : server_(openServer(recording)), out_(out, std::ios::binary), random_(seed) {
    if (session_.open({.of_this_machine = true}, localTime(0.0)))
      throw std::runtime_error("a session without a token is refused");
    poll(0);
  }
  void run(int ticks) {
    for (int tick = 1; tick <= ticks; ++tick) step(tick);
    out_.flush();
    if (!out_) throw std::runtime_error("the script cannot be written");
    std::cout << touched_ << " of " << ticks << " ticks in contact, at most " << most_N_ << " N\n";
  }

 private:
  static RecordedServer openServer(const std::string& file) {
    auto opened = RecordedServer::open(file);
    if (!opened.ok()) throw std::runtime_error(file + ": " + opened.error().message);
    return std::move(opened).value();
  }
  static MediaTime at(double time_ms) { return mediaTime(1e-3 * time_ms); }

  void step(int tick) {
    while (auto message = server_.poll(at(tick))) {
      // A whole number of us, so that both sides round to the same time.
      last_ms_ = std::max(last_ms_, tick + 1e-3 * static_cast<double>(random_() % 8000));
      if (!isPicture(*message)) arrivals_.push_back({last_ms_, std::move(*message)});
    }
    for (; !arrivals_.empty() && arrivals_.front().time_ms <= tick; arrivals_.pop_front())
      deliver(arrivals_.front());
    render(tick);
    poll(tick);
  }
  /// Sends what the session has for the server, as the page's core does after each tick.
  void poll(int tick) {
    while (const auto message = session_.poll(localTime(1e-3 * tick)))
      server_.receive(encode(*message), at(tick));
  }
  static bool isPicture(const std::vector<std::uint8_t>& bytes) {
    const auto message = decode(bytes);
    return message.ok() && std::holds_alternative<VideoFrame>(message.value());
  }
  void deliver(const Arrival& arrival) {
    player_.push(arrival.bytes, 1e-3 * arrival.time_ms);
    if (!session_.receive(arrival.bytes, localTime(1e-3 * arrival.time_ms)).ok())
      throw std::runtime_error("a message of the server is refused");
    put(std::uint8_t{1});
    put(arrival.time_ms);
    put(static_cast<std::uint32_t>(arrival.bytes.size()));
    out_.write(reinterpret_cast<const char*>(arrival.bytes.data()),
               static_cast<std::streamsize>(arrival.bytes.size()));
  }
  void render(int tick) {
    const double time_s = 1e-3 * tick;
    const Eigen::Vector3d slide_mm(8.0 * std::sin(2.1 * time_s), 6.0 * std::sin(3.3 * time_s), 0.0);
    const double press_mm = 3.0 * std::sin(5.0 * time_s);
    const Eigen::Vector3d goal_mm(object_mm_.x() + slide_mm.x(), object_mm_.y() + slide_mm.y(),
                                  height_mm_ + 1.0 - press_mm);
    clock_.set(localTime(time_s));
    hand_.moveTowards(renderer_.toDevice(goal_mm));
    (void)hand_.exchange(force_N_, {});
    const Vec3 position_mm = hand_.tip_mm();  // not rounded to counts: see client/web/README.md
    player_.release(time_s);
    const Tick& report = renderer_.tick(time_s, position_mm);
    if (report.object_id != 0) object_mm_ = report.object_mm;
    if (report.height_mm != 0.0) height_mm_ = report.height_mm;
    force_N_ = report.force_N;
    touched_ += report.contact ? 1 : 0;
    most_N_ = std::max(most_N_, report.force_N.norm());
    put(std::uint8_t{2});
    put(static_cast<double>(tick));
    for (int i = 0; i < 3; ++i) put(position_mm[i]);
    for (int i = 0; i < 3; ++i) put(report.force_N[i]);
  }
  template <class T>
  void put(const T& value) {
    out_.write(reinterpret_cast<const char*>(&value), sizeof(T));
  }

  RecordedServer server_;
  client::ClientSession session_{{}, nullptr};  // its pings are those of the page
  std::ofstream out_;
  std::mt19937 random_;
  Renderer renderer_;
  MessagePlayer player_{renderer_};
  std::deque<Arrival> arrivals_;
  double last_ms_ = 0.0;
  SetClock clock_;
  client::PointedHand hand_{client::PlantProfile(), clock_};
  Vec3 force_N_ = Vec3::Zero();
  Eigen::Vector3d object_mm_ = Eigen::Vector3d::Zero();
  double height_mm_ = 20.0;
  int touched_ = 0;
  double most_N_ = 0.0;
};

}  // namespace
}  // namespace hapticast::testing

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "hapticast-force-script RECORDING.mcap OUT SECONDS SEED\n";
    return 2;
  }
  try {
    hapticast::testing::Script script(argv[1], argv[2],
                                      static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10)));
    script.run(static_cast<int>(std::lround(1e3 * std::strtod(argv[3], nullptr))));
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
