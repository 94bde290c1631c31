// SPDX-License-Identifier: MIT
#include "client/haptics/realtime_thread.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace hapticast::client {

namespace {
constexpr int kPriority = 80;  // above interrupt threads' usual 50, below the kernel's own

bool lockMemory() noexcept {
  // Under a limit, locking all future memory would make later allocations fail instead.
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  if (!unlimited && geteuid() != 0) return false;
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
}
}  // namespace

RealtimeGrant requestRealtime() noexcept {
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  RealtimeGrant grant;
  grant.fifo = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
  grant.mlock = lockMemory();
  return grant;
}

}  // namespace hapticast::client
