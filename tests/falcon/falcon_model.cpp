// SPDX-License-Identifier: MIT
#include "tests/falcon/falcon_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/falcon/falcon_arms.hpp"
#include "tests/support/falcon_bytes.hpp"

namespace hapticast::testing {

namespace {

using client::FalconFrame;
using client::FalconReply;
using client::FalconRequest;
using namespace std::chrono_literals;

constexpr std::uint16_t kBootBaud = 0x4138;
constexpr std::uint16_t kLoadBaud = 0x0015;
constexpr std::uint16_t kRunBaud = 0x0002;
constexpr Duration kFrameTime = 107us;  // 16 characters at 1.5 Mbaud
constexpr Duration kByteTime = 70us;    // one at about 143 kbaud
constexpr std::size_t kPacket = 62;
// A hand that holds the grip of a light device.
constexpr double kMass_kg = 0.25;
constexpr double kHand_N_m = 200.0;
constexpr double kHandDamping_Ns_m = 10.0;
constexpr double kHandSpeed_m_s = 0.15;
// Nobody holds it.
constexpr double kGripMass_kg = 0.1;
constexpr double kGripDamping_Ns_m = 2.0;
constexpr double kStep_s = 1e-4;

}  // namespace

void FalconModel::powerCycle() {
  stage_ = Stage::kBootLoader;
  homed_ = 0;
  was_out_ = false;
  said_.clear();
  line_.clear();
  image_.clear();
  zero_ = {-150, 250, 50};
}

void FalconModel::control(std::uint8_t request, std::uint16_t value) {
  if (request == 0 && value != 2) said_.clear();
  if (request == 0 && value != 1) line_.clear();
  if (request == 0 && value == 0) event_character_.reset();
  if (request == 1) setLines(value);
  if (request == 3) divisor_ = value;
  if (request == 6) {
    event_character_.reset();
    if ((value & 0x0100U) != 0) event_character_ = static_cast<std::uint8_t>(value & 0xFFU);
  }
  if (request == 9) latency_ = std::chrono::milliseconds(value);
}

/// The high byte says which lines are set: 1 is DTR, 2 is RTS.
void FalconModel::setLines(std::uint16_t value) {
  if ((value & 0x0200U) != 0) rts_ = (value & 0x02U) != 0;
  if ((value & 0x0100U) == 0) return;
  const bool ready = (value & 0x01U) != 0;
  if (ready && !dtr_) dtr_rose_ = true;
  dtr_ = ready;
}

void FalconModel::write(std::span<const std::uint8_t> bytes, LocalTime now) {
  for (const std::uint8_t byte : bytes) {
    if (std::exchange(dtr_rose_, false)) loader_from_ = now + faults.loader_delay;
    if (stage_ == Stage::kBootLoader && divisor_ == kBootBaud && dtr_ && !rts_ &&
        now >= loader_from_)
      handleBoot(byte, now);
    if (stage_ == Stage::kBootLoader && divisor_ == kLoadBaud && byte == 0x41 && !dtr_) {
      stage_ = Stage::kLoads;
      image_.clear();
      say(std::array{byte}, now + kByteTime);
    } else if ((stage_ == Stage::kLoads || stage_ == Stage::kStuck) && divisor_ == kLoadBaud) {
      handleImage(byte, now);
    } else if ((stage_ == Stage::kLoads || stage_ == Stage::kStuck) && divisor_ == kBootBaud) {
      stage_ = Stage::kBootLoader;  // its ready line was toggled
      handleBoot(byte, now);
    } else if (stage_ == Stage::kRuns && divisor_ == kRunBaud && now >= runs_from_) {
      handleFrame(byte, now);
    }
  }
}

void FalconModel::handleBoot(std::uint8_t byte, LocalTime now) {
  constexpr std::array<std::uint8_t, 3> kHello = {0x0A, 0x43, 0x0D};
  constexpr std::array<std::uint8_t, 5> kAnswer = {0x00, 0x0A, 0x44, 0x2C, 0x0D};
  line_.push_back(byte);
  if (line_.size() > kHello.size()) line_.erase(line_.begin());
  if (!std::equal(line_.begin(), line_.end(), kHello.begin(), kHello.end())) return;
  line_.clear();
  if (faults.hellos_ignored-- > 0) return;
  say(kAnswer, now + 5ms);
}

void FalconModel::handleImage(std::uint8_t byte, LocalTime now) {
  image_.push_back(byte);
  std::uint8_t echo = byte;
  if (image_.size() % 300 == 0 && faults.echoes_wrong > 0) {
    --faults.echoes_wrong;
    echo ^= 0x10;
  }
  const LocalTime begin = said_.empty() ? now : std::max(now, said_.back().ready);
  say(std::array{echo}, begin + kByteTime);
  if (image_.size() != firmware_.size()) return;
  ++loads_;
  stage_ = image_ == firmware_ ? Stage::kRuns : Stage::kStuck;
  runs_from_ = now + faults.start_delay;
}

void FalconModel::handleFrame(std::uint8_t byte, LocalTime now) {
  if (byte == '<') line_.clear();
  line_.push_back(byte);
  if (line_.size() != FalconFrame{}.size()) return;
  FalconFrame frame{};
  std::copy(line_.begin(), line_.end(), frame.begin());
  line_.clear();
  if (const auto request = decodeRequest(frame)) act(*request, now);
}

void FalconModel::act(const FalconRequest& request, LocalTime now) {
  if (!received_.empty()) {
    // Until now the motors did what the request before said.
    const double time_s = std::min(toSeconds(now - received_.back().at), 0.05);
    move(time_s, received_.back().request.motors);
  }
  received_.push_back({now, request, position_m_});
  home(request);
  if (!faults.mute) reply(now);
}

Vec3 FalconModel::handTarget_m() {
  if (!homes_itself || homed_ == client::kAllHomed) return target_m;
  return {0.0, 0.0, was_out_ ? 0.090 : 0.165};
}

void FalconModel::move(double time_s, const std::array<int, 3>& motors) {
  const Vec3 counts(motors[0], motors[1], motors[2]);
  const Vec3 motor_N = counts.isZero() ? Vec3(counts) : forceAt_N(position_m_, counts, gain);
  const Vec3 goal_m = handTarget_m();
  for (double done_s = 0.0; done_s < time_s; done_s += kStep_s) {
    Vec3 way_m = goal_m - position_m_;
    const double most_m = kHandSpeed_m_s * kHandDamping_Ns_m / kHand_N_m;
    const Vec3 hand_N = kHand_N_m * (way_m.norm() > 2.0 * most_m + 0.02
                                         ? Vec3(way_m * ((2.0 * most_m + 0.02) / way_m.norm()))
                                         : way_m);
    const bool held = !let_go || homed_ != client::kAllHomed;
    const Vec3 outside_N = held ? Vec3(hand_N - kHandDamping_Ns_m * velocity_m_s_)
                                : Vec3(-kGripDamping_Ns_m * velocity_m_s_);
    const Vec3 weight_N = -9.80665 * (held ? 0.0 : weight_kg) * Vec3::UnitY();
    const double mass_kg = held ? kMass_kg : kGripMass_kg + weight_kg;
    velocity_m_s_ += kStep_s / mass_kg * (motor_N + outside_N + weight_N);
    position_m_ += kStep_s * velocity_m_s_;
  }
}

void FalconModel::home(const FalconRequest& request) {
  if (!request.homing || faults.homing_lost) {
    homed_ = 0;
    was_out_ = false;
    faults.homing_lost = false;
    return;
  }
  if (homed_ == client::kAllHomed) return;
  was_out_ = was_out_ || position_m_.z() > 0.155;
  if (!was_out_) return;
  // One axis after the other passes its mark on the way in.
  const std::array<double, 3> marks_m = {0.120, 0.115, 0.110};
  for (std::size_t i = 0; i < 3; ++i) {
    if (position_m_.z() > marks_m[i]) continue;
    homed_ = static_cast<std::uint8_t>(homed_ | 1U << i);
    zero_[i] = 0;
  }
}

void FalconModel::reply(LocalTime now) {
  FalconReply reply{.buttons = buttons, .homed = homed_};
  const Vec3 counts = encodersAt(position_m_);
  for (std::size_t i = 0; i < 3; ++i)
    reply.encoders[i] =
        static_cast<int>(std::lround(counts[static_cast<Eigen::Index>(i)])) + zero_[i];
  const FalconFrame frame = encodeReply(reply);
  std::vector<std::uint8_t> bytes(frame.begin(), frame.end());
  if (oneIn(faults.one_in_lost)) return;
  if (oneIn(faults.one_in_cut)) bytes.resize(bytes.size() / 2);
  if (oneIn(faults.one_in_flipped)) {
    const auto at = std::uniform_int_distribution<std::size_t>(0, 8 * bytes.size() - 1)(random_);
    bytes[at / 8] = static_cast<std::uint8_t>(bytes[at / 8] ^ 1U << (at % 8));
  }
  if (oneIn(faults.one_in_garbage)) {
    const std::array<std::uint8_t, 6> noise = {0xFF, '<', 'A', 'B', '<', 0x07};
    bytes.insert(bytes.begin(), noise.begin(), noise.end());
  }
  say(bytes, now + 2 * kFrameTime);
}

void FalconModel::say(std::span<const std::uint8_t> bytes, LocalTime ready) {
  said_.push_back({{bytes.begin(), bytes.end()}, ready});
}

LocalTime FalconModel::due() const {
  LocalTime timer = last_packet_ + latency_;
  std::size_t bytes = 0;
  for (const Said& said : said_) {
    bytes += said.bytes.size();
    if (bytes < kPacket) continue;
    timer = std::min(timer, said.ready);
    break;
  }
  if (said_.empty()) return timer;
  const bool event =
      event_character_ && std::find(said_.front().bytes.begin(), said_.front().bytes.end(),
                                    *event_character_) != said_.front().bytes.end();
  return event ? std::min(said_.front().ready, timer) : timer;
}

std::optional<std::vector<std::uint8_t>> FalconModel::packet(LocalTime now) {
  std::size_t ready = 0;
  bool event = false;
  for (const Said& said : said_) {
    if (said.ready > now) break;
    ready += said.bytes.size();
    event = event || (event_character_ && std::find(said.bytes.begin(), said.bytes.end(),
                                                    *event_character_) != said.bytes.end());
  }
  if (ready < kPacket && !event && now < last_packet_ + latency_) return std::nullopt;
  last_packet_ = now;
  if (faults.empty_packets && piece_ % 3 == 1) {
    ++piece_;
    return std::vector<std::uint8_t>(piece_ % 2);  // shorter than a status
  }
  constexpr std::array<std::size_t, 4> kPieces = {5, 5, 5, 1};
  const std::size_t most = faults.split ? kPieces[piece_ % 4] : kPacket;
  ++piece_;
  std::vector<std::uint8_t> bytes = {0x01, 0x60};  // status of modem and line
  while (bytes.size() < most + 2 && !said_.empty() && said_.front().ready <= now) {
    auto& from = said_.front().bytes;
    const auto count = static_cast<std::ptrdiff_t>(std::min(most + 2 - bytes.size(), from.size()));
    bytes.insert(bytes.end(), from.begin(), from.begin() + count);
    from.erase(from.begin(), from.begin() + count);
    if (from.empty()) said_.pop_front();
  }
  return bytes;
}

}  // namespace hapticast::testing
