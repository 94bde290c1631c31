// SPDX-License-Identifier: MIT
#include "tests/support/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace hapticast::testing {

namespace {
std::string temporaryFile() {
  const char* const folder = std::getenv("TMPDIR");
  std::string name = std::string(folder != nullptr ? folder : "/tmp") + "/hapticast_out_XXXXXX";
  const int file = ::mkstemp(name.data());
  if (file < 0) throw std::runtime_error(name + ": cannot be made");
  ::close(file);
  return name;
}

/// In the child: nothing but system calls until the program runs.
void prepareChild(const char* input_file, const char* output_file) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that is killed leaves nothing running
  ::signal(SIGHUP, SIG_DFL);           // which nohup leaves ignored
  int input = ::open(input_file, O_RDONLY | O_NOCTTY);
  if (::isatty(input) != 0 && ::setsid() > 0) input = ::open(input_file, O_RDWR);
  // Appending, so that both streams write behind each other.
  const int output = ::open(output_file, O_WRONLY | O_APPEND);
  ::dup2(input, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
}
}  // namespace

Process::Process(std::vector<std::string> command, const std::string& input)
    : output_file_(temporaryFile()) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& each : command) arguments.push_back(each.data());
  arguments.push_back(nullptr);
  if (!forkChild(command.front())) return;
  prepareChild(input.c_str(), output_file_.c_str());
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

Process::Process(const std::function<int()>& program) : output_file_(temporaryFile()) {
  if (!forkChild("a main function")) return;
  prepareChild("/dev/null", output_file_.c_str());
  const int exit_code = program();
  (void)std::fflush(nullptr);
  ::_exit(exit_code);  // the test's own ends (of GoogleTest, of statics) are the parent's
}

bool Process::forkChild(const std::string& program) {
  (void)std::fflush(nullptr);  // what waits in the test's buffers is written once
  pid_ = ::fork();
  if (pid_ >= 0) return pid_ == 0;
  ::unlink(output_file_.c_str());
  throw std::runtime_error(program + ": " + std::strerror(errno));
}

Process::~Process() {
  if (running()) {
    signal(SIGKILL);
    (void)wait(std::chrono::seconds(10));
  }
  ::unlink(output_file_.c_str());
}

std::string Process::output() const {
  std::ostringstream text;
  text << std::ifstream(output_file_, std::ios::binary).rdbuf();
  return text.str();
}

bool Process::says(const std::string& text, std::chrono::seconds deadline, std::size_t times) {
  bool ended = false;
  (void)waitUntil(deadline, [&] {
    ended = !running();  // before the look at the output, so that its last words count
    return countOccurrences(text, output()) >= times || ended;
  });
  return countOccurrences(text, output()) >= times;
}

std::optional<int> Process::wait(std::chrono::seconds deadline) {
  (void)waitUntil(deadline, [this] { return !running(); });
  return exit_code_;
}

void Process::signal(int number) const {
  if (!exit_code_) ::kill(pid_, number);
}

bool Process::running() {
  if (exit_code_) return false;
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return true;
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return false;
}

long Process::residentMemory_kB() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  }
  return 0;
}

std::size_t countOccurrences(const std::string& text, const std::string& where) {
  std::size_t count = 0;
  for (std::size_t at = where.find(text); at != std::string::npos; at = where.find(text, at + 1))
    ++count;
  return count;
}

}  // namespace hapticast::testing
