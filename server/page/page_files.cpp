// SPDX-License-Identifier: MIT
#include "server/page/page_files.hpp"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>

namespace hapticast::server {

namespace {
constexpr int kGzip = 16 + MAX_WBITS;  // of zlib: expect the header of gzip
constexpr std::size_t kChunk_bytes = 64U << 10U;
}  // namespace

const PageFile* findPageFile(std::string_view path, std::span<const PageFile> files) {
  if (!path.starts_with('/')) return nullptr;
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const auto& each) { return each.name == name; });
  return found == files.end() ? nullptr : &*found;
}

bool isPageComplete(std::span<const PageFile> files) {
  return findPageFile("/", files) != nullptr && findPageFile("/core.wasm", files) != nullptr;
}

std::vector<std::uint8_t> inflate(const PageFile& file) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::runtime_error("zlib failed");
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): zlib does not write to it
  stream.next_in = const_cast<Bytef*>(file.gzipped.data());
  stream.avail_in = static_cast<uInt>(file.gzipped.size());
  std::vector<std::uint8_t> content;
  int result = Z_OK;
  while (result == Z_OK) {
    content.resize(stream.total_out + kChunk_bytes);
    stream.next_out = content.data() + stream.total_out;
    stream.avail_out = static_cast<uInt>(kChunk_bytes);
    result = ::inflate(&stream, Z_NO_FLUSH);
  }
  content.resize(stream.total_out);
  inflateEnd(&stream);
  if (result != Z_STREAM_END) throw std::runtime_error("a file of the page is damaged");
  return content;
}

}  // namespace hapticast::server
