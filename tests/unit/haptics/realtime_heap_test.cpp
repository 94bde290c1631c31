// SPDX-License-Identifier: MIT
// The tick allocates nothing: malloc and its family end the program while a tick runs. (Sanitizers
// bring their own.)
#ifndef HAPTICAST_SANITIZED

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <memory>

#include "tests/support/renderer_fixture.hpp"

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

#pragma GCC visibility push(default)  // libstdc++ calls these functions, not glibc's
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
void* memalign(std::size_t alignment, std::size_t size) {
  check();
  return __libc_memalign(alignment, size);
}
void free(void* old) {
  check();
  __libc_free(old);
}
}
#pragma GCC visibility pop

namespace hapticast::client {
namespace {

void live(const RendererSettings& settings) {
  HandScript hand{HandKind::kSlide, HandStiffness{}};
  auto log = std::make_unique<HapticRenderer::Log>();
  RendererFixture stage(settings, &hand, 3.0, log.get());
  stage.before_tick = [] { heap_forbidden = true; };
  stage.after_tick = [] { heap_forbidden = false; };
  int contact = 0;
  for (int i = 0; i < 6000; ++i) {
    if (i == 3000 || i == 3500) stage.newEpoch();
    if (i == 4000 || i == 4200) {
      stage.pause(!stage.wishes.paused);
      stage.state.workspace.width_mm = 180.0;
      stage.stream.store(stage.state);
    }
    if (i == 5000) stage.streaming = false;
    stage.lost = i == 5900;
    stage.blind = i == 4500;
    contact += stage.step().contact;
  }
  EXPECT_GT(contact, 500);
}

TEST(RealtimeHeap, TheTickUsesNone) {
  for (const Method method : {Method::kHapticast, Method::kThesis}) {
    for (const SurfaceKind surface :
         {SurfaceKind::kPerturbed, SurfaceKind::kNormal, SurfaceKind::kProxy}) {
      for (const Interpolation interpolation :
           {Interpolation::kHermite, Interpolation::kLinear, Interpolation::kHold}) {
        RendererSettings settings;
        settings.method = method;
        settings.surface = surface;
        settings.interpolation = interpolation;
        live(settings);
      }
    }
  }
}

/// Each way to the heap, called so that no compiler can leave it out.
TEST(RealtimeHeapDeathTest, TheGuardDetectsEveryAllocation) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  struct alignas(64) Wide {
    char bytes[64];
  };
  void* (*volatile get)(std::size_t) = std::malloc;
  void* (*volatile get_zero)(std::size_t, std::size_t) = std::calloc;
  void* (*volatile get_again)(void*, std::size_t) = std::realloc;
  void* (*volatile get_aligned)(std::size_t, std::size_t) = std::aligned_alloc;
  void (*volatile give_back)(void*) = std::free;
  void* const block = get(8);
  Wide* volatile wide = nullptr;
  const std::function<void()> ways[] = {
      [] { delete new volatile int(1); },
      [&] { wide = new Wide; },  // aligned
      [&] { (void)get(8); },
      [&] { (void)get_zero(8, 8); },
      [&] { (void)get_again(block, 1024); },
      [&] { (void)get_aligned(64, 64); },
      [&] { give_back(block); },
  };
  for (const auto& way : ways) {
    EXPECT_DEATH(
        {
          heap_forbidden = true;
          way();
        },
        "heap used inside a tick");
  }
  give_back(block);
}

}  // namespace
}  // namespace hapticast::client

#endif
