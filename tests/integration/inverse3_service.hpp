// SPDX-License-Identifier: MIT
// The Inverse service on a loopback port, in the process of the test: it answers each message with
// one state, moves a device in a hand, and records the forces. Its JSON and its axes are its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast::testing {

class Inverse3Service {
 public:
  /// `version` goes into the inventory; before 3.5 the force is named `values`.
  explicit Inverse3Service(std::string version = "3.5.1");
  ~Inverse3Service();
  Inverse3Service(const Inverse3Service&) = delete;
  Inverse3Service& operator=(const Inverse3Service&) = delete;

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// A force of the client in the device frame, N, and its time (CLOCK_MONOTONIC).
  struct Force {
    std::int64_t time_ns = 0;
    Vec3 force_N = Vec3::Zero();
  };
  [[nodiscard]] std::vector<Force> forces() const;
  [[nodiscard]] double lastForce_N() const;
  [[nodiscard]] int messages() const { return messages_; }
  [[nodiscard]] int foreignForces() const { return foreign_; }

  /// From now on: "nan", "no_position", "text", "silent", "long", "close", "gone", "uncalibrated",
  /// "" for none.
  void misbehave(const std::string& fault);
  /// The hand releases the grip.
  void releaseGrip() { free_ = true; }

 private:
  void serve();
  void talk(int socket);
  std::string answer(const std::string& message);
  std::string stateText();
  void move();

  std::string version_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  mutable std::mutex mutex_;
  std::vector<Force> forces_;
  std::string fault_;
  Vec3 position_mm_{0.0, 0.0, 25.0};  // device frame
  Vec3 speed_mm_s_ = Vec3::Zero();
  std::int64_t begin_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::atomic<int> messages_{0};
  std::atomic<int> foreign_{0};
  std::atomic<bool> free_{false};
  std::atomic<bool> stop_{false};
  std::atomic<int> socket_{-1};
  std::thread thread_;
};

}  // namespace hapticast::testing
