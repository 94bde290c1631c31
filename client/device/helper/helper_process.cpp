// SPDX-License-Identifier: MIT
#include "client/device/helper/helper_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "common/installed_file.hpp"

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;

constexpr auto kEndPatience = std::chrono::seconds(5);

[[noreturn]] void failStart(const std::string& program, int error) {
  throw std::runtime_error(program + ": cannot be started: " + std::strerror(error) +
                           "; it belongs into the folder of hapticast-client");
}

/// Settings of posix_spawn: a session of its own, so that Ctrl-C in the terminal ends the client
/// first; the default handling of all signals.
class SpawnSettings {
 public:
  SpawnSettings(int socket, int page) {
    posix_spawnattr_init(&attributes_);
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawn_file_actions_adddup2(&actions_, socket, kHelperSocket);
    if (page >= 0) posix_spawn_file_actions_adddup2(&actions_, page, kHelperPage);
  }
  ~SpawnSettings() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  /// Starts `arguments`. Returns 0 or the error.
  int spawn(pid_t& pid, std::vector<std::string>& arguments) const {
    std::vector<char*> pointers;
    pointers.reserve(arguments.size() + 1);
    for (std::string& each : arguments) pointers.push_back(each.data());
    pointers.push_back(nullptr);
    return posix_spawn(&pid, pointers.front(), &actions_, &attributes_, pointers.data(), environ);
  }

 private:
  posix_spawnattr_t attributes_{};
  posix_spawn_file_actions_t actions_{};
};

/// Duplicates a descriptor to a number that the dup2() of SpawnSettings does not overwrite.
int moveUp(int file_descriptor) {
  constexpr int kAbove = 10;
  const int moved = fcntl(file_descriptor, F_DUPFD_CLOEXEC, kAbove);
  close(file_descriptor);
  return moved;
}

}  // namespace

std::string findHelperProgram() { return findInstalledFile("hapticast-device"); }

HelperProcess::HelperProcess(const std::string& program, const std::string& driver,
                             const char* task, const std::map<std::string, std::string>& options,
                             const PageMapping* page) {
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0)
    failStart(program, errno);
  socket_ = sockets[0];
  const int theirs = moveUp(sockets[1]);
  const int shared = page == nullptr ? -1 : moveUp(dup(page->fileDescriptor()));
  std::vector<std::string> arguments{program, driver, task};
  for (const auto& [key, value] : options) {
    if (!value.empty()) arguments.emplace_back(key).append("=").append(value);
  }
  const int error = SpawnSettings(theirs, shared).spawn(pid_, arguments);
  close(theirs);
  if (shared >= 0) close(shared);
  if (error == 0) return;
  close(socket_);
  failStart(program, error);
}

HelperProcess::~HelperProcess() { (void)end(); }

std::string HelperProcess::end() {
  if (pid_ < 0) return "";
  close(socket_);
  const pid_t pid = std::exchange(pid_, -1);
  int status = 0;
  const auto until = std::chrono::steady_clock::now() + kEndPatience;
  pid_t result = 0;
  while ((result = waitpid(pid, &status, WNOHANG)) == 0 && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(milliseconds(1));
  if (result == 0) {
    kill(pid, SIGKILL);
    (void)waitpid(pid, &status, 0);
    return "no end within five seconds";
  }
  if (result < 0) return "an unknown reason";
  if (WIFSIGNALED(status))
    return "signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace hapticast::client
