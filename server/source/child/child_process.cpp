// SPDX-License-Identifier: MIT
#include "server/source/child/child_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

// Chosen: a program needs less to end, and the picture stands still meanwhile.
constexpr auto kEndPatience = std::chrono::milliseconds(300);
// A picture of 640 x 480 px fits; more needs a privilege.
constexpr int kPipe_bytes = 1 << 20;

[[noreturn]] void throwStartError(const std::string& command, int error) {
  throw SourceError(command + ": cannot be started (" + std::generic_category().message(error) +
                    ")");
}

/// Both ends of a pipe.
struct Pipe {
  OwnedDescriptor read;
  OwnedDescriptor write;
};

Pipe makePipe(const std::string& command) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throwStartError(command, errno);
  (void)::fcntl(ends[0], F_SETPIPE_SZ, kPipe_bytes);
  return {OwnedDescriptor(ends[0]), OwnedDescriptor(ends[1])};
}

/// Moves a descriptor to a number that the dup2() of the child's stdin to stderr does not
/// overwrite.
OwnedDescriptor moveUp(const OwnedDescriptor& descriptor) {
  return OwnedDescriptor(::fcntl(descriptor.get(), F_DUPFD_CLOEXEC, 3));
}

/// Settings of posix_spawn: a session of its own, the default handling of all signals, and no
/// descriptors but the three pipes.
class ShellSpawn {
 public:
  ShellSpawn(int input, int output, int errors) {
    posix_spawnattr_init(&attributes_);
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    sigset_t signals;
    sigfillset(&signals);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes_, &signals);
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, errors, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  ~ShellSpawn() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  ShellSpawn(const ShellSpawn&) = delete;
  ShellSpawn& operator=(const ShellSpawn&) = delete;

  /// Starts the shell with `command`. Returns 0 or the error.
  int run(pid_t& pid, std::string command) const {
    std::string shell = "/bin/sh";
    std::string flag = "-c";
    const std::array<char*, 4> arguments{shell.data(), flag.data(), command.data(), nullptr};
    return ::posix_spawn(&pid, shell.c_str(), &actions_, &attributes_, arguments.data(), environ);
  }

 private:
  posix_spawnattr_t attributes_{};
  posix_spawn_file_actions_t actions_{};
};

/// Waits for the end of a child, at most kEndPatience. Returns as waitpid() does.
pid_t waitForEnd(pid_t pid, int& status) {
  const auto until = std::chrono::steady_clock::now() + kEndPatience;
  pid_t result = ::waitpid(pid, &status, WNOHANG);
  while (result == 0 && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    result = ::waitpid(pid, &status, WNOHANG);
  }
  return result;
}

std::string describeStatus(int status) {
  if (!WIFSIGNALED(status)) return "exit code " + std::to_string(WEXITSTATUS(status));
  return "signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
}

}  // namespace

void OwnedDescriptor::close() {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

ChildProcess::ChildProcess(const std::string& command) {
  Pipe in = makePipe(command);
  Pipe out = makePipe(command);
  Pipe err = makePipe(command);
  const OwnedDescriptor their_in = moveUp(in.read);
  const OwnedDescriptor their_out = moveUp(out.write);
  const OwnedDescriptor their_err = moveUp(err.write);
  const int error = ShellSpawn(their_in.get(), their_out.get(), their_err.get()).run(pid_, command);
  if (error != 0) throwStartError(command, error);
  input = std::move(in.write);
  output = std::move(out.read);
  errors = std::move(err.read);
  for (const OwnedDescriptor* const end : {&input, &output, &errors})
    (void)::fcntl(end->get(), F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() { (void)end(); }

std::string ChildProcess::end() {
  if (pid_ < 0) return "";
  for (OwnedDescriptor* const end : {&input, &output, &errors}) end->close();
  const pid_t pid = std::exchange(pid_, -1);
  int status = 0;
  pid_t result = waitForEnd(pid, status);
  if (result == 0) {
    (void)::kill(-pid, SIGTERM);
    result = waitForEnd(pid, status);
  }
  (void)::kill(-pid, SIGKILL);  // also what the child itself has started
  if (result == 0) (void)::waitpid(pid, &status, 0);
  return result < 0 ? "an unknown reason" : describeStatus(status);
}

}  // namespace hapticast::server
