// SPDX-License-Identifier: MIT
// Two network namespaces with a cable between them: two machines as far as the network goes. What
// it takes (root, `ip netns`) is not allowed everywhere. Thread: one.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace hapticast::testing {

class TwoHosts {
 public:
  static constexpr const char* kServer4 = "10.77.0.1";
  static constexpr const char* kViewer4 = "10.77.0.2";
  static constexpr const char* kServer6 = "fd77::1";
  static constexpr const char* kViewer6 = "fd77::2";
  static constexpr const char* kServerLink = "hcserver";  ///< each end's interface
  static constexpr const char* kViewerLink = "hcviewer";

  TwoHosts() {
    const std::string s = server(), v = viewer();
    works_ = run("ip netns add " + s) && run("ip netns add " + v) &&
             run("ip -n " + s + " link add " + kServerLink + " type veth peer name " + kViewerLink +
                 " netns " + v) &&
             plug(s, kServerLink, kServer4, kServer6) && plug(v, kViewerLink, kViewer4, kViewer6);
  }
  ~TwoHosts() {
    (void)run("ip netns del " + server());
    (void)run("ip netns del " + viewer());
  }
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  [[nodiscard]] bool works() const { return works_; }
  [[nodiscard]] std::string server() const { return name_ + "s"; }
  [[nodiscard]] std::string viewer() const { return name_ + "v"; }
  /// What a program is started with, to be on that host.
  [[nodiscard]] static std::vector<std::string> runOn(const std::string& host,
                                                      std::vector<std::string> command) {
    command.insert(command.begin(), {"/usr/bin/env", "ip", "netns", "exec", host});
    return command;
  }
  /// Runs `make` on that host: the sockets that it opens stay there.
  template <class Make>
  static auto madeOn(const std::string& host, const Make& make) {
    decltype(make()) made{};
    std::exception_ptr failed;
    std::thread([&] {
      try {
        const int there = ::open(("/run/netns/" + host).c_str(), O_RDONLY | O_CLOEXEC);
        const bool moved = there >= 0 && ::setns(there, CLONE_NEWNET) == 0;
        ::close(there);
        if (!moved) throw std::runtime_error("cannot enter the network of " + host);
        made = make();
      } catch (...) {
        failed = std::current_exception();
      }
    }).join();
    if (failed) std::rethrow_exception(failed);
    return made;
  }

 private:
  static bool run(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
  }
  static bool plug(const std::string& host, const char* link, const char* v4, const char* v6) {
    const std::string ip = "ip -n " + host + " ", dev = std::string(" dev ") + link;
    return run(ip + "link set lo up") && run(ip + "link set " + link + " up") &&
           run(ip + "addr add " + v4 + "/24" + dev) &&
           run(ip + "addr add " + v6 + "/64" + dev + " nodad");
  }

  std::string name_ = "hc" + std::to_string(::getpid());
  bool works_ = false;
};

}  // namespace hapticast::testing
