// SPDX-License-Identifier: MIT
// Writers of NPY and NPZ files for tests. They share no code with the readers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace hapticast::server {

/// Returns `value` as `count` bytes, the lowest first.
inline std::string littleEndian(std::uint64_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) {
    bytes += static_cast<char>(value & 0xFFU);
    value >>= 8U;
  }
  return bytes;
}

inline std::string toBytes(const cv::Mat& matrix) {
  return {reinterpret_cast<const char*>(matrix.data), matrix.total() * matrix.elemSize()};
}

/// Returns an NPY file. `shape` is the text between the brackets, such as "3, 24, 32".
inline std::string npyFile(const std::string& type, const std::string& shape,
                           const std::string& content, int version = 1,
                           const std::string& fortran = "False") {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': (" + shape + "), }";
  const int length_bytes = version == 1 ? 2 : 4;
  while ((8U + static_cast<unsigned>(length_bytes) + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  return "\x93NUMPY" + littleEndian(static_cast<unsigned>(version), 2) +
         littleEndian(header.size(), length_bytes) + header + content;
}

/// Returns `content` as a deflate stream of blocks without compression.
inline std::string deflate(const std::string& content) {
  constexpr std::size_t kBlock_bytes = 1000;
  std::string stream;
  for (std::size_t at = 0; at < content.size(); at += kBlock_bytes) {
    const std::string block = content.substr(at, kBlock_bytes);
    stream += at + kBlock_bytes >= content.size() ? '\1' : '\0';
    stream += littleEndian(block.size(), 2) + littleEndian(~block.size(), 2) + block;
  }
  return stream;
}

inline std::uint32_t crc32Of(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

/// A member of an NPZ file.
struct NpzMember {
  std::string name;  ///< with its ending ".npy"
  std::string content;
  int method = 8;  ///< 0: stored, 8: deflated
};

/// Returns an NPZ file, which is a ZIP archive.
inline std::string npzFile(const std::vector<NpzMember>& members) {
  std::string file;
  std::string directory;
  for (const NpzMember& member : members) {
    const std::string packed = member.method == 8 ? deflate(member.content) : member.content;
    const std::string facts = littleEndian(20, 2) + littleEndian(0, 2) +
                              littleEndian(static_cast<unsigned>(member.method), 2) +
                              littleEndian(0x210000, 4) + littleEndian(crc32Of(member.content), 4) +
                              littleEndian(packed.size(), 4) +
                              littleEndian(member.content.size(), 4) +
                              littleEndian(member.name.size(), 2) + littleEndian(0, 2);
    for (const std::string& part : {std::string("PK\x01\x02"), littleEndian(20, 2), facts,
                                    littleEndian(0, 10), littleEndian(file.size(), 4), member.name})
      directory += part;
    for (const std::string& part : {std::string("PK\x03\x04"), facts, member.name, packed})
      file += part;
  }
  const std::string count = littleEndian(members.size(), 2);
  return file + directory + "PK\x05\x06" + littleEndian(0, 4) + count + count +
         littleEndian(directory.size(), 4) + littleEndian(file.size(), 4) + littleEndian(0, 2);
}

}  // namespace hapticast::server
