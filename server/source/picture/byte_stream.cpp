// SPDX-License-Identifier: MIT
#include "server/source/picture/byte_stream.hpp"

#include <cstring>
#include <system_error>
#include <utility>

namespace hapticast::server {

namespace {

class FileStream final : public ByteStream {
 public:
  FileStream(std::ifstream file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] bool read(std::span<std::uint8_t> target) override {
    file_.read(reinterpret_cast<char*>(target.data()), static_cast<std::streamsize>(target.size()));
    return static_cast<bool>(file_);
  }
  [[nodiscard]] bool seek(std::uint64_t offset) override {
    file_.clear();  // after a read beyond the end
    return static_cast<bool>(file_.seekg(static_cast<std::streamoff>(offset)));
  }
  [[nodiscard]] bool seeksBackwards() const override { return true; }

 private:
  std::ifstream file_;
  std::uint64_t size_;
};

}  // namespace

bool MemoryStream::read(std::span<std::uint8_t> target) {
  if (bytes_.size() - at_ < target.size()) return false;
  if (!target.empty()) std::memcpy(target.data(), bytes_.data() + at_, target.size());
  at_ += target.size();
  return true;
}

bool MemoryStream::seek(std::uint64_t offset) {
  if (offset > bytes_.size()) return false;
  at_ = static_cast<std::size_t>(offset);
  return true;
}

StreamResult openFileStream(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return {nullptr, "cannot be read (" + error.message() + ")"};
  std::ifstream in(file, std::ios::binary);
  if (!in) return {nullptr, "cannot be read"};
  return {std::make_unique<FileStream>(std::move(in), size), ""};
}

}  // namespace hapticast::server
