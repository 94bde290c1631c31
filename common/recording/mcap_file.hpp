// SPDX-License-Identifier: MIT
// Bytes of a recording that is open for reading. A source of its own, because a web page reads its
// recording over the network (client/web). Thread: one.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/result.hpp"

namespace hapticast {

/// A file that is open for reading.
class McapFile {
 public:
  /// Opens `file`. Returns an error without the file's name.
  [[nodiscard]] static Result<McapFile> open(const std::string& file);
  /// Returns another handle of the same file. Returns an error if the system has none.
  [[nodiscard]] Result<McapFile> reopen() const;
  ~McapFile();
  McapFile(McapFile&& from) noexcept : handle_(from.handle_), size_(from.size_) {
    from.handle_ = -1;
  }
  McapFile& operator=(McapFile&& from) noexcept;

  /// Returns the size at the time of open(), bytes.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `out` with the bytes from `offset`. Returns their number, which is smaller at the end of
  /// the file and after an error.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  McapFile(int handle, std::uint64_t size) : handle_(handle), size_(size) {}

  int handle_;
  std::uint64_t size_;
};

}  // namespace hapticast
