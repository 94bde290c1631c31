// SPDX-License-Identifier: MIT
// Bytes of a file or of a member of an archive, which are read in pieces. Thread: any; at most one
// at a time for each stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace hapticast::server {

/// Returns `bytes` as text (a view).
[[nodiscard]] inline std::string_view toText(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Bytes from outside with a known number.
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Returns how many bytes the stream should have. The content may be shorter.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Fills `target` with the next bytes. Returns false if the stream is shorter or damaged.
  [[nodiscard]] virtual bool read(std::span<std::uint8_t> target) = 0;
  /// Moves to the byte `offset`, counted from 0. Returns false if that is impossible.
  [[nodiscard]] virtual bool seek(std::uint64_t offset) = 0;
  /// Returns whether seek() backwards takes no longer than forwards.
  [[nodiscard]] virtual bool seeksBackwards() const = 0;
};

/// A stream, or null and the problem: a phrase to append to the file's name, such as "is cut off".
struct StreamResult {
  std::unique_ptr<ByteStream> stream;
  std::string problem;
};

/// Bytes in memory.
class MemoryStream final : public ByteStream {
 public:
  /// Requires `bytes` to outlive the stream.
  explicit MemoryStream(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] bool read(std::span<std::uint8_t> target) override;
  [[nodiscard]] bool seek(std::uint64_t offset) override;
  [[nodiscard]] bool seeksBackwards() const override { return true; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// Returns the bytes of `file`, or its problem.
[[nodiscard]] StreamResult openFileStream(const std::filesystem::path& file);

}  // namespace hapticast::server
