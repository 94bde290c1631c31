// SPDX-License-Identifier: MIT
#include "server/show/bake/bake_progress.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace hapticast::server {

namespace {
constexpr Duration kLineEvery = std::chrono::milliseconds(200);  // chosen: readable figures
constexpr Duration kLogEvery = std::chrono::seconds(10);         // chosen: a short log
}  // namespace

BakeProgress::BakeProgress(const Clock& clock, bool quiet)
    : clock_(clock), quiet_(quiet), on_terminal_(::isatty(STDERR_FILENO) != 0) {
  begin("");
}

void BakeProgress::begin(std::string work) {
  work_ = std::move(work);
  began_ = shown_ = clock_.now();
}

void BakeProgress::show(std::uint64_t done, std::uint64_t total) {
  const LocalTime now = clock_.now();
  if (quiet_ || now - shown_ < (on_terminal_ ? kLineEvery : kLogEvery)) return;
  shown_ = now;
  const std::string text = describeProgress(work_, done, total, toSeconds(now - began_));
  if (!on_terminal_) return spdlog::info("{}", text);
  std::fprintf(stderr, "\r%s\033[K", text.c_str());
  std::fflush(stderr);
  has_line_ = true;
}

void BakeProgress::clear() {
  if (!std::exchange(has_line_, false)) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

std::string describeProgress(const std::string& work, std::uint64_t done, std::uint64_t total,
                             double elapsed_s) {
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
  if (total == 0 || rate <= 0.0)
    return fmt::format("{}: {} frames, {:.1f} frames/s", work, done, rate);
  const std::uint64_t left = total - std::min(done, total);
  const auto left_s = static_cast<std::uint64_t>(std::llround(static_cast<double>(left) / rate));
  return fmt::format(
      "{}: {:.0f} %, {:.1f} frames/s, {}:{:02} left", work,
      100.0 * static_cast<double>(std::min(done, total)) / static_cast<double>(total), rate,
      left_s / 60, left_s % 60);
}

}  // namespace hapticast::server
