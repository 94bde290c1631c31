// SPDX-License-Identifier: MIT
// A network of its own for the process of a test and the programs that it starts: a namespace with
// loopback alone. No program outside can bind one of its ports. Thread: one, before there are
// others.
#pragma once

#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <string>

namespace hapticast::testing {

/// Enters a new network. Returns false if the system allows none (root, or user namespaces).
inline bool enterOwnNetwork() {
  const std::string user = std::to_string(::geteuid()), group = std::to_string(::getegid());
  if (::unshare(CLONE_NEWNET) != 0) {
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
    // The same user and group as before.
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << user << " " << user << " 1";
    std::ofstream("/proc/self/gid_map") << group << " " << group << " 1";
  }
  const int asks = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq loopback{};
  std::strcpy(loopback.ifr_name, "lo");
  loopback.ifr_flags = IFF_UP | IFF_RUNNING;
  const bool up = ::ioctl(asks, SIOCSIFFLAGS, &loopback) == 0;
  ::close(asks);
  return up;
}

}  // namespace hapticast::testing
