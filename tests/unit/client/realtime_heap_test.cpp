// SPDX-License-Identifier: MIT
// The tick allocates nothing: malloc and its family end the program while a tick runs. (Sanitizers
// bring their own.)
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/unit/client/stage.hpp"

namespace {
thread_local bool heap_forbidden = false;

void check() {
  if (!heap_forbidden) return;
  heap_forbidden = false;
  constexpr char kMessage[] = "heap used inside a tick\n";
  (void)!write(STDERR_FILENO, kMessage, sizeof(kMessage) - 1);
  std::abort();
}
}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): glibc's names
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) {
  check();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  check();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  check();
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  check();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  check();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
void free(void* old) {
  check();
  __libc_free(old);
}
}

namespace hapticast::client {
namespace {

TEST(RealtimeHeap, TheTickUsesNone) {
  for (const Method method : {Method::kHapticast, Method::kThesis}) {
    for (const SurfaceKind surface : {SurfaceKind::kPerturbed, SurfaceKind::kNormal}) {
      RoomSettings settings;
      settings.method = method;
      settings.surface = surface;
      HandScript hand{HandKind::kSlide, HandStiffness{}};
      Stage stage(settings, &hand, 3.0);
      stage.before_tick = [] { heap_forbidden = true; };
      stage.after_tick = [] { heap_forbidden = false; };
      int contact = 0;
      for (int i = 0; i < 6000; ++i) {
        if (i == 3000 || i == 3500) stage.newEpoch();
        if (i == 5000) stage.streaming = false;
        stage.lost = i == 5900;
        contact += stage.step().contact;
      }
      EXPECT_GT(contact, 500);
    }
  }
}

TEST(RealtimeHeapDeathTest, TheGuardSeesAnAllocation) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        heap_forbidden = true;
        int* volatile leak = new int(1);
        delete leak;
      },
      "heap used inside a tick");
}

}  // namespace
}  // namespace hapticast::client

#endif
