// SPDX-License-Identifier: MIT
#include "server/source/folder/text_file.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

std::string readText(const fs::path& file) {
  constexpr std::uintmax_t kMaxText_bytes = 16U << 20U;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw SourceError(file.string() + ": cannot be read (" + error.message() + ")");
  if (size > kMaxText_bytes) {
    throw SourceError(file.string() + ": is larger than 16 MiB; that is no list of frames");
  }
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) throw SourceError(file.string() + ": cannot be read");
  return text;
}

}  // namespace hapticast::server
