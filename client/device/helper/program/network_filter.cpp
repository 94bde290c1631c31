// SPDX-License-Identifier: MIT
#include "client/device/helper/program/network_filter.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace hapticast::client {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW;
constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EACCES;

constexpr sock_filter load(std::uint32_t offset) {
  return {BPF_LD | BPF_W | BPF_ABS, 0, 0, offset};
}
constexpr sock_filter jumpIfEqual(std::uint32_t value, std::uint8_t then, std::uint8_t otherwise) {
  return {BPF_JMP | BPF_JEQ | BPF_K, then, otherwise, value};
}
constexpr sock_filter answer(std::uint32_t action) { return {BPF_RET | BPF_K, 0, 0, action}; }

}  // namespace

bool refuseNetwork() noexcept {
  // A system call of another architecture (32 bit) would have other numbers: refused as a whole.
  constexpr std::uint32_t kArg0 = offsetof(seccomp_data, args);  // little-endian: its lower half
  std::array filter{
      load(offsetof(seccomp_data, arch)),
      jumpIfEqual(kArchitecture, 1, 0),
      answer(kRefuse),
      load(offsetof(seccomp_data, nr)),
      jumpIfEqual(SYS_io_uring_setup, 5, 0),
      jumpIfEqual(SYS_socket, 0, 5),
      load(kArg0),
      jumpIfEqual(AF_INET, 2, 0),
      jumpIfEqual(AF_INET6, 1, 0),
      jumpIfEqual(AF_PACKET, 0, 1),
      answer(kRefuse),
      answer(kAllow),
  };
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return kArchitecture != 0 && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace hapticast::client
