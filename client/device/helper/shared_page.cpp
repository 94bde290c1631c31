// SPDX-License-Identifier: MIT
#include "client/device/helper/shared_page.hpp"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <new>
#include <system_error>

#include "client/device/sleep_until.hpp"

namespace hapticast::client {

namespace {

[[noreturn]] void failPage(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

void Doorbell::ring() noexcept {
  rings_.fetch_add(1, std::memory_order_release);
  (void)syscall(SYS_futex, &rings_, FUTEX_WAKE, std::numeric_limits<int>::max(), nullptr, nullptr,
                0);
}

void Doorbell::wait(std::uint32_t seen, LocalTime deadline) const noexcept {
  const timespec until = toTimespec(deadline);
  while (rings() == seen) {
    const long result = syscall(SYS_futex, &rings_, FUTEX_WAIT_BITSET, seen, &until, nullptr,
                                FUTEX_BITSET_MATCH_ANY);
    if (result != 0 && errno == ETIMEDOUT) return;
  }
}

PageMapping::PageMapping() : file_descriptor_(memfd_create("hapticast-device", MFD_CLOEXEC)) {
  if (file_descriptor_ < 0 || ftruncate(file_descriptor_, sizeof(SharedPage)) != 0)
    failPage("shared memory for the device");
  map();
  new (page_) SharedPage();
}

PageMapping::PageMapping(int file_descriptor) : file_descriptor_(file_descriptor) { map(); }

void PageMapping::map() {
  void* const memory =
      mmap(nullptr, sizeof(SharedPage), PROT_READ | PROT_WRITE, MAP_SHARED, file_descriptor_, 0);
  if (memory == MAP_FAILED) failPage("shared memory for the device");
  page_ = static_cast<SharedPage*>(memory);
}

PageMapping::~PageMapping() {
  munmap(page_, sizeof(SharedPage));
  close(file_descriptor_);
}

}  // namespace hapticast::client
