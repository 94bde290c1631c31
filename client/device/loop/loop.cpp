// SPDX-License-Identifier: MIT
#include "client/device/loop/loop.hpp"

#include <algorithm>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
// Upper bound of the ramp to zero; the ranges of a profile need far less.
constexpr int kStopTicks = 2000;
}  // namespace

void LoopStats::add(const TickReport& report, double step_N) noexcept {
  ++ticks;
  ++lookup[static_cast<std::size_t>(report.lookup)];
  for (std::size_t i = 0; i < safety_actions.size(); ++i) {
    safety_actions[i] += (report.safety_actions >> i) & 1U;
  }
  ++faults[static_cast<std::size_t>(report.fault)];
  if (report.contact) {
    ++contact_ticks;
    ++contact_lookup[static_cast<std::size_t>(report.lookup)];
  }
  max_force_N = std::max(max_force_N, report.force_N.norm());
  max_force_step_N = std::max(max_force_step_N, step_N);
  step_excess_max_N = std::max(step_excess_max_N, report.step_excess_N);
  work = report.work;
  safety_states |= report.safety_states;
}

void runLoop(HapticDevice& device, HapticRenderer& renderer, const Clock& clock,
             const std::atomic<bool>& stop, LoopStats& stats) noexcept {
  Vec3 force_N = Vec3::Zero();
  LocalTime last = clock.now();
  LocalTime deadline = last + kTickPeriod;
  int ticks_to_stop = kStopTicks;
  bool stopping = false;
  while (ticks_to_stop > 0 && !(stopping && force_N == Vec3::Zero())) {
    device.waitForTick(deadline);
    const LocalTime begin = clock.now();
    if (begin - last > kLateTick) ++stats.late_ticks;
    last = begin;
    const DeviceState state = device.exchange(force_N, renderer.report());
    const LocalTime exchanged = clock.now();
    stopping = stopping || stop.load(std::memory_order_relaxed);
    if (stopping) {
      renderer.stop();
      --ticks_to_stop;
    }
    const TickReport& report = renderer.tick(begin, state);
    device.sendForceEarly(report.force_N);
    const LocalTime end = clock.now();
    stats.exchange_ns.add((exchanged - begin).count());
    stats.tick_ns.add((end - exchanged).count());
    renderer.setLastTickDuration(end - exchanged);
    stats.add(report, (report.force_N - force_N).norm());
    force_N = report.force_N;
    deadline = std::min(deadline, begin) + kTickPeriod;
    if (end >= deadline) deadline += ((end - deadline) / kTickPeriod + 1) * kTickPeriod;
  }
  (void)device.exchange(Vec3::Zero(), renderer.report());
}

LoopThread::LoopThread(HapticDevice& device, HapticRenderer& renderer, const Clock& clock)
    : thread_([this, &device, &renderer, &clock] {
        realtime_ = requestRealtime();
        flushDenormals();
        runLoop(device, renderer, clock, stop_, stats_);
      }) {}

void LoopThread::stop() noexcept {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace hapticast::client
