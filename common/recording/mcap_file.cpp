// SPDX-License-Identifier: MIT
#include "common/recording/mcap_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace hapticast {

Result<McapFile> McapFile::open(const std::string& file) {
  const int opened = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // no wait at a FIFO
  struct stat facts {};
  if (opened < 0 || ::fstat(opened, &facts) != 0) {
    const std::string why = std::system_category().message(errno);
    if (opened >= 0) ::close(opened);
    return Error{"cannot be read (" + why + ")"};
  }
  McapFile result(opened, static_cast<std::uint64_t>(facts.st_size));
  if (!S_ISREG(facts.st_mode)) return Error{"is no MCAP file"};
  return result;
}

Result<McapFile> McapFile::reopen() const {
  const int file = ::fcntl(handle_, F_DUPFD_CLOEXEC, 0);
  if (file < 0)
    return Error{"cannot be opened again (" + std::system_category().message(errno) + ")"};
  return McapFile(file, size_);
}

McapFile::~McapFile() {
  if (handle_ >= 0) ::close(handle_);
}

McapFile& McapFile::operator=(McapFile&& from) noexcept {
  std::swap(handle_, from.handle_);
  size_ = from.size_;
  return *this;
}

std::size_t McapFile::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  std::size_t done = 0;
  while (done < out.size()) {
    const ::ssize_t count =
        ::pread(handle_, out.data() + done, out.size() - done, static_cast<::off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

}  // namespace hapticast
