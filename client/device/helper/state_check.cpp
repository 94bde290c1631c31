// SPDX-License-Identifier: MIT
#include "client/device/helper/state_check.hpp"

#include <algorithm>
#include <chrono>

namespace hapticast::client {

namespace {
constexpr double kMostWorkspaces = 1.5;    // chosen: rest positions lie outside of the workspace
constexpr double kFastestTip_mm_ms = 5.0;  // chosen: a hand reaches some 3 m/s
constexpr Duration kOldest = std::chrono::milliseconds(20);
}  // namespace

void StateCheck::restart() noexcept {
  number_ = 0;
  lost_ = false;
  accepted_any_ = false;
}

std::optional<StateCheck::Finding> StateCheck::findFault(const hapticast_state& state,
                                                         LocalTime now) const noexcept {
  const Vec3 position_mm(state.position_mm[0], state.position_mm[1], state.position_mm[2]);
  if (!position_mm.allFinite()) return Finding::kNotFinite;
  if ((position_mm.array().abs() > kMostWorkspaces * workspace_mm_.array()).any())
    return Finding::kOutside;
  const LocalTime taken{Duration(state.taken_ns)};
  if (taken > now) return Finding::kFuture;
  if (!accepted_any_) return std::nullopt;
  if (taken < last_.time) return Finding::kTimeBack;
  const double since_ms = std::max(1e3 * toSeconds(taken - last_.time), 1.0);
  if ((position_mm - last_.position_mm).norm() > kFastestTip_mm_ms * since_ms)
    return Finding::kTooFast;
  return std::nullopt;
}

DeviceState StateCheck::check(const DeviceReading& reading, LocalTime now) noexcept {
  const hapticast_state& state = reading.state;
  last_.status = lost_ ? DeviceStatus::kLost : DeviceStatus::kNoData;
  if (reading.number == 0 || reading.number == number_) return last_;
  number_ = reading.number;
  lost_ = false;
  last_.status = DeviceStatus::kNoData;
  if (state.status == HAPTICAST_NO_DATA) return last_;
  std::optional<Finding> fault;
  if (state.status != HAPTICAST_OK && state.status != HAPTICAST_LOST) fault = Finding::kStatus;
  if (state.status == HAPTICAST_OK) fault = findFault(state, now);
  if (fault) counts_[static_cast<std::size_t>(*fault)].fetch_add(1, std::memory_order_relaxed);
  if (state.status != HAPTICAST_OK) {
    lost_ = true;
    last_.status = DeviceStatus::kLost;
    return last_;
  }
  const LocalTime taken{Duration(state.taken_ns)};
  if (fault || (accepted_any_ && taken == last_.time) || taken < now - kOldest) return last_;
  accepted_any_ = true;
  last_.position_mm = {state.position_mm[0], state.position_mm[1], state.position_mm[2]};
  last_.buttons = state.buttons;
  last_.time = taken;
  last_.status = DeviceStatus::kOk;
  return last_;
}

const char* toText(StateCheck::Finding finding) noexcept {
  switch (finding) {
    case StateCheck::Finding::kNotFinite:
      return "a position that is not a number";
    case StateCheck::Finding::kOutside:
      return "a position far outside of its workspace";
    case StateCheck::Finding::kTooFast:
      return "a jump of its position";
    case StateCheck::Finding::kTimeBack:
      return "a position older than the one before";
    case StateCheck::Finding::kFuture:
      return "a position with a time in the future";
    case StateCheck::Finding::kStatus:
      return "an unknown status";
  }
  return "";
}

}  // namespace hapticast::client
