// SPDX-License-Identifier: MIT
// A Falcon as it looks from its USB port: serial chip, boot loader, firmware, arms, and a hand that
// holds the grip. Time is an argument. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "client/device/falcon/protocol.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::testing {

/// The faults; changed while it runs.
struct FalconFaults {
  Duration loader_delay{0};    ///< from DTR to the boot loader
  Duration start_delay{0};     ///< from the last byte of the firmware to its first answer
  int hellos_ignored = 0;      ///< the boot loader oversleeps so many
  int echoes_wrong = 0;        ///< so many chunks of the firmware come back with a flipped bit
  bool mute = false;           ///< it receives and does not answer
  int one_in_lost = 0;         ///< of so many replies one is lost; 0: none
  int one_in_cut = 0;          ///< ... loses its end
  int one_in_flipped = 0;      ///< ... has a flipped bit
  int one_in_garbage = 0;      ///< ... comes behind noise
  bool split = false;          ///< replies come in packets of 5, 5, 5 and 1 bytes
  bool empty_packets = false;  ///< packets without even a status come in between
  bool homing_lost = false;    ///< it forgets where it is; taken back when it is homed again
};

/// One request as the motors got it.
struct ReceivedRequest {
  LocalTime at;
  client::FalconRequest request;
  Vec3 position_m = Vec3::Zero();  ///< of the grip at that time
};

class FalconModel {
 public:
  /// It runs only with this firmware.
  explicit FalconModel(std::vector<std::uint8_t> firmware) : firmware_(std::move(firmware)) {}

  // What the host does.
  void control(std::uint8_t request, std::uint16_t value);
  void write(std::span<const std::uint8_t> bytes, LocalTime now);
  /// The next packet for the host, if one is due.
  std::optional<std::vector<std::uint8_t>> packet(LocalTime now);
  /// When there will be one, if nothing else happens.
  [[nodiscard]] LocalTime due() const;

  // What the test does and sees.
  FalconFaults faults;
  std::uint8_t buttons = 0;
  Vec3 target_m{0.0, 0.0, 0.125};  ///< where the hand wants the grip
  bool let_go = false;             ///< nobody holds the grip
  double weight_kg = 0;            ///< what hangs on it
  bool homes_itself = true;        ///< the hand pulls out and pushes in whenever the light is red
  void powerCycle();
  void boot() { stage_ = Stage::kRuns; }  ///< as if its firmware had been loaded
  [[nodiscard]] bool runs() const { return stage_ == Stage::kRuns; }
  [[nodiscard]] int loads() const { return loads_; }
  /// All requests; the last one acts until the next.
  [[nodiscard]] const std::vector<ReceivedRequest>& received() const { return received_; }
  [[nodiscard]] Vec3 position_m() const { return position_m_; }
  [[nodiscard]] std::uint8_t homed() const { return homed_; }
  double gain = 3500.0;  ///< its own, counts a N m

 private:
  enum class Stage { kBootLoader, kLoads, kStuck, kRuns };

  void setLines(std::uint16_t value);
  void handleBoot(std::uint8_t byte, LocalTime now);
  void handleImage(std::uint8_t byte, LocalTime now);
  void handleFrame(std::uint8_t byte, LocalTime now);
  void act(const client::FalconRequest& request, LocalTime now);
  void move(double time_s, const std::array<int, 3>& motors);
  void home(const client::FalconRequest& request);
  Vec3 handTarget_m();
  void reply(LocalTime now);
  void say(std::span<const std::uint8_t> bytes, LocalTime ready);
  bool oneIn(int n) { return n > 0 && std::uniform_int_distribution<int>(1, n)(random_) == 1; }

  struct Said {
    std::vector<std::uint8_t> bytes;
    LocalTime ready;
  };

  std::vector<std::uint8_t> firmware_;
  Stage stage_ = Stage::kBootLoader;
  int loads_ = 0;
  std::uint16_t divisor_ = 0;
  bool dtr_ = false;
  bool rts_ = true;
  bool dtr_rose_ = false;
  LocalTime loader_from_{};
  LocalTime runs_from_{};
  Duration latency_{16'000'000};
  std::optional<std::uint8_t> event_character_;
  LocalTime last_packet_{};
  std::deque<Said> said_;
  std::vector<std::uint8_t> image_;
  std::vector<std::uint8_t> line_;  // what came since the last whole word or frame
  std::vector<ReceivedRequest> received_;
  Vec3 position_m_{0.0, 0.0, 0.115};
  Vec3 velocity_m_s_ = Vec3::Zero();
  std::array<int, 3> zero_{300, -200, 100};  // encoders are relative until they are homed
  std::uint8_t homed_ = 0;
  bool was_out_ = false;
  std::mt19937 random_{7};
  std::size_t piece_ = 0;
};

}  // namespace hapticast::testing
