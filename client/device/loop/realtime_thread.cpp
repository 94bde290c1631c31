// SPDX-License-Identifier: MIT
#include "client/device/loop/realtime_thread.hpp"

#include <link.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace hapticast::client {

namespace {
// Above the usual 50 of interrupt threads, below the kernel's own 99.
constexpr int kPriority = 80;
constexpr std::size_t kStack_bytes = 256 << 10;  // chosen: many times the depth of a tick

/// Loads and locks the memory from `begin` on. A refusal costs a page fault later.
void lockRange(std::uintptr_t begin, std::size_t bytes) noexcept {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t first = begin / page * page;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the dynamic linker reports addresses as numbers
  (void)!mlock(reinterpret_cast<const void*>(first), begin - first + bytes);
}

/// Loads and locks the code and the data that the loop uses: the program and the C and C++
/// libraries. Callback of dl_iterate_phdr.
int lockLoopCode(dl_phdr_info* object, std::size_t /*size*/, void* /*data*/) noexcept {
  constexpr std::array<const char*, 4> kOfLoop{"/libc.so", "/libm.so", "/libstdc++.so",
                                               "/libgcc_s.so"};
  const std::string_view name = object->dlpi_name;
  const bool used =
      name.empty() || std::any_of(kOfLoop.begin(), kOfLoop.end(), [&](const char* each) {
        return name.find(each) != std::string_view::npos;
      });
  for (int i = 0; used && i < object->dlpi_phnum; ++i) {
    const auto& segment = object->dlpi_phdr[i];
    if (segment.p_type == PT_LOAD) lockRange(object->dlpi_addr + segment.p_vaddr, segment.p_memsz);
  }
  return 0;
}

/// Locks each page of the process after its first use, and loads the loop's code at once. Without
/// MCL_ONFAULT the kernel would load 270 MB of libraries and stacks that the client does not use.
bool lockMemory() noexcept {
  // Under a limit, locked future memory would make later allocations fail.
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  if (!unlimited && geteuid() != 0) return false;
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) return false;
  (void)dl_iterate_phdr(lockLoopCode, nullptr);
  const auto here = reinterpret_cast<std::uintptr_t>(&limit);
  lockRange(here - kStack_bytes, kStack_bytes);
  return true;
}
}  // namespace

RealtimeGrant requestRealtime(int above) noexcept {
  sched_param parameters{};
  parameters.sched_priority = kPriority + above;
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
