// SPDX-License-Identifier: MIT
// The recording of a page, which the page reads over the network (page/player.js).
#include "common/recording/mcap_file.hpp"

#include <utility>

extern "C" __attribute__((import_module("page"), import_name("file_size"))) double getFileSize();
extern "C" __attribute__((import_module("page"), import_name("read"))) std::size_t readFile(
    double offset, std::size_t size, std::uint8_t* to);

namespace hapticast {

Result<McapFile> McapFile::open(const std::string& /*file*/) {
  return McapFile(0, static_cast<std::uint64_t>(getFileSize()));
}

Result<McapFile> McapFile::reopen() const { return McapFile(0, size_); }

McapFile::~McapFile() = default;

McapFile& McapFile::operator=(McapFile&& from) noexcept {
  size_ = from.size_;
  return *this;
}

std::size_t McapFile::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  return readFile(static_cast<double>(offset), out.size(), out.data());
}

}  // namespace hapticast
