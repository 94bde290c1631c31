// SPDX-License-Identifier: MIT
#include "common/private_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <system_error>

namespace hapticast {

namespace {

Error addReason(const std::string& what, int number) {
  return Error{what + " (" + std::system_category().message(number) + ")"};
}

/// Returns the absolute path in an environment variable; empty if there is none.
std::filesystem::path folderFromEnvironment(const char* variable) {
  const char* const value = std::getenv(variable);
  std::filesystem::path path(value == nullptr ? "" : value);
  return path.is_absolute() ? path : std::filesystem::path();
}

/// Writes all of `text` and waits until the disk has it. Returns false and sets errno on failure.
bool writeAll(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0;
}

}  // namespace

std::filesystem::path stateFolder() {
  auto of_service = folderFromEnvironment("STATE_DIRECTORY");
  if (!of_service.empty()) return of_service;
  const auto state = folderFromEnvironment("XDG_STATE_HOME");
  if (!state.empty()) return state / "hapticast";
  const auto home = folderFromEnvironment("HOME");
  return home.empty() ? "." : home / ".local/state/hapticast";
}

Result<std::string> readSmallFile(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (error) return addReason("cannot be read", error.value());
  if (!std::filesystem::is_regular_file(status)) return Error{"cannot be read (it is no file)"};
  std::ifstream in(file, std::ios::binary);
  if (!in) return addReason("cannot be read", errno);
  std::string text(kMaxSmallFile_bytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxSmallFile_bytes) return Error{"cannot be read (it is larger than 1 MiB)"};
  return text;
}

std::optional<Error> writePrivateFile(const std::filesystem::path& file, std::string_view text) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::string temporary = file.string() + ".XXXXXX";
  const int descriptor = ::mkostemp(temporary.data(), O_CLOEXEC);  // mode 0600
  if (descriptor < 0) return addReason("cannot be written", errno);
  bool done = writeAll(descriptor, text);
  int number = errno;
  ::close(descriptor);
  if (done) {
    done = std::rename(temporary.c_str(), file.c_str()) == 0;
    number = errno;
  }
  if (done) return std::nullopt;
  ::unlink(temporary.c_str());
  return addReason("cannot be written", number);
}

}  // namespace hapticast
