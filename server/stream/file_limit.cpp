// SPDX-License-Identifier: MIT
#include "server/stream/file_limit.hpp"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

namespace {
// Chosen: files of the source, the log, the event loop; 11 were measured.
constexpr rlim_t kOwnFiles = 64;
}  // namespace

std::size_t raiseFileLimit(std::size_t viewers) {
  constexpr rlim_t kBeside = kOwnFiles + Broadcaster::kMaxPending;
  const rlim_t needed = viewers + kBeside;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return viewers;
  limit.rlim_cur = std::min(needed, limit.rlim_max);
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur >= needed) return viewers;
  if (limit.rlim_cur <= kBeside) {
    spdlog::warn(
        "this system allows {} open files, fewer than the server itself may need ({}): "
        "one viewer is let in (ulimit -Hn {} allows {})",
        limit.rlim_cur, kBeside, needed, viewers);
    return 1;
  }
  const rlim_t fit = limit.rlim_cur - kBeside;
  spdlog::warn(
      "--max-clients {}: this system allows {} open files, which is enough for {} viewers; more "
      "of them are turned away (ulimit -Hn {} allows all)",
      viewers, limit.rlim_cur, fit, needed);
  return fit;
}

}  // namespace hapticast::server
