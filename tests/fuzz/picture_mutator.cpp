// SPDX-License-Identifier: MIT
// Mutations that get past a picture's front door: the checksums of a PNG's chunks are made right
// again, and now and then a JPEG's size is the one that the client expects.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

constexpr std::size_t kSignature = 8;

std::uint32_t crcOf(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void mendPng(std::span<std::uint8_t> file) {
  for (std::size_t at = kSignature; at + 12 <= file.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8U | file[at + i];
    if (length > file.size() - at - 12) {  // cut: the chunk ends with the file
      length = file.size() - at - 12;
      for (std::size_t i = 0; i < 4; ++i)
        file[at + i] = static_cast<std::uint8_t>(length >> (8U * (3 - i)));
    }
    const std::uint32_t crc = crcOf(file.subspan(at + 4, 4 + length));
    for (std::size_t i = 0; i < 4; ++i)
      file[at + 8 + length + i] = static_cast<std::uint8_t>(crc >> (8U * (3 - i)));
    at += 12 + length;
  }
}

/// 32 x 16 in the first frame header.
void mendJpeg(std::span<std::uint8_t> file) {
  constexpr std::array<std::uint8_t, 4> kSize = {0, 16, 0, 32};
  for (std::size_t i = 2; i + 9 < file.size(); ++i) {
    const bool header = file[i] == 0xFF && file[i + 1] >= 0xC0 && file[i + 1] <= 0xC2;
    if (!header) continue;
    std::copy(kSize.begin(), kSize.end(), file.begin() + static_cast<std::ptrdiff_t>(i + 5));
    return;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
  const bool png = size > kSignature && data[0] == 0x89;
  const bool jpeg = size > 2 && data[0] == 0xFF && data[1] == 0xD8;
  // The signature stays, or nothing behind it would be read.
  const std::size_t head = png ? kSignature : jpeg ? 2 : 0;
  const std::size_t mutated = head + LLVMFuzzerMutate(data + head, size - head, max_size - head);
  if (png && seed % 8 != 0) mendPng({data, mutated});
  if (jpeg && seed % 2 != 0) mendJpeg({data, mutated});
  return mutated;
}
