// SPDX-License-Identifier: MIT
#include "client/haptics/realtime_thread.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace hapticast::client {

namespace {
// Above the usual 50 of interrupt threads, below the kernel's own 99.
constexpr int kPriority = 80;

bool lockMemory() noexcept {
  // Under a limit, locked future memory would make later allocations fail.
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

void flushDenormals() noexcept {
#if defined(__SSE2__)
  constexpr unsigned kFlushToZero = 0x8000;       // results
  constexpr unsigned kDenormalsAreZero = 0x0040;  // operands
  _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
#elif defined(__aarch64__)
  constexpr std::uint64_t kFlushToZero = std::uint64_t{1} << 24U;  // operands and results
  std::uint64_t control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  asm volatile("msr fpcr, %0" : : "r"(control | kFlushToZero));
#endif
}

}  // namespace hapticast::client
