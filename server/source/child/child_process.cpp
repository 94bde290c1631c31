// SPDX-License-Identifier: MIT
#include "server/source/child/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string_view>
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
  OwnedDescriptor moved(::fcntl(descriptor.get(), F_DUPFD_CLOEXEC, 3));
  if (moved.get() < 0) throwStartError("a program", errno);
  return moved;
}

/// Returns the command for the shell. The shell is replaced by the program where the command is one
/// program with arguments, so that signals and the end of the pipes are the program's own.
std::string replaceShell(const std::string& command) {
  // Words of the shell that are no programs.
  constexpr std::array<std::string_view, 26> kWords{
      "!",      ".",    ":",     "alias",  "break", "case",  "cd",    "command", "continue",
      "eval",   "exec", "exit",  "export", "for",   "if",    "local", "read",    "readonly",
      "return", "set",  "shift", "trap",   "type",  "umask", "until", "while"};
  const std::size_t begin = std::min(command.find_first_not_of(' '), command.size());
  const std::string first = command.substr(begin, command.find(' ', begin) - begin);
  const bool is_program = command.find_first_of(";|&<>(){}\n\t") == std::string::npos &&
                          first.find('=') == std::string::npos &&
                          std::find(kWords.begin(), kWords.end(), first) == kWords.end();
  return is_program ? "exec " + command : command;
}

/// The new process: becomes the shell. Only functions that are safe between fork() and exec().
[[noreturn]] void execShell(pid_t parent, const std::array<int, 3>& ends, const char* command) {
  (void)::prctl(PR_SET_PDEATHSIG, SIGTERM);  // it does not outlive the server
  if (::getppid() != parent) ::_exit(1);
  (void)::setsid();
  sigset_t none;
  sigemptyset(&none);
  (void)::sigprocmask(SIG_SETMASK, &none, nullptr);
  (void)::signal(SIGPIPE, SIG_DFL);
  for (int i = 0; i < 3; ++i) (void)::dup2(ends[static_cast<std::size_t>(i)], i);
  (void)::close_range(3, ~0U, 0);
  ::execl("/bin/sh", "sh", "-c", command, nullptr);
  ::_exit(127);
}

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

ChildProcess::ChildProcess(const std::string& command) {
  Pipe in = makePipe(command);
  Pipe out = makePipe(command);
  Pipe err = makePipe(command);
  const OwnedDescriptor their_in = moveUp(in.read);
  const OwnedDescriptor their_out = moveUp(out.write);
  const OwnedDescriptor their_err = moveUp(err.write);
  const std::string text = replaceShell(command);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throwStartError(command, errno);
  if (pid_ == 0)
    execShell(parent, {their_in.get(), their_out.get(), their_err.get()}, text.c_str());
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
  const bool was_ended = result == 0;
  if (was_ended) {
    (void)::kill(-pid, SIGTERM);
    result = waitForEnd(pid, status);
  }
  (void)::kill(-pid, SIGKILL);  // also what the child itself has started
  if (result == 0) (void)::waitpid(pid, &status, 0);
  return was_ended || result < 0 ? "" : describeStatus(status);
}

}  // namespace hapticast::server
