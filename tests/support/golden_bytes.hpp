// SPDX-License-Identifier: MIT
// Golden bytes: the files unit/common/golden/*.hex, and the code blocks of pages that show bytes.
// Both have pairs of hex digits. With HAPTICAST_UPDATE_GOLDEN=1 in the environment expectGolden()
// writes the file anew. Only for test programs, which define HAPTICAST_TESTS.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace hapticast::testing {

inline std::filesystem::path testsFolder() { return HAPTICAST_TESTS; }

inline bool updatesGolden() { return std::getenv("HAPTICAST_UPDATE_GOLDEN") != nullptr; }

/// Writes a file of bytes, for example a seed of a fuzzer.
inline void writeBytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// Returns lines of 16 bytes.
inline std::string toHexLines(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string lines;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    lines += {kDigits[bytes[i] >> 4U], kDigits[bytes[i] & 15U]};
    lines += i % 16 == 15 ? '\n' : ' ';
  }
  return lines + '\n';
}

/// Appends the bytes of the pairs of digits that a line begins with.
inline void appendBytesOfLine(const std::string& line, std::vector<std::uint8_t>& bytes) {
  std::istringstream words(line);
  for (std::string word; words >> word && word.size() == 2;) {
    if (word.find_first_not_of("0123456789abcdef") != std::string::npos) return;
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
}

inline std::filesystem::path goldenFile(const std::string& name) {
  return testsFolder() / "unit/common/golden" / (name + ".hex");
}

/// Returns no bytes if the file is missing.
inline std::vector<std::uint8_t> readGolden(const std::string& name) {
  std::ifstream in(goldenFile(name));
  std::vector<std::uint8_t> bytes;
  for (std::string line; std::getline(in, line);) appendBytesOfLine(line, bytes);
  return bytes;
}

inline void expectGolden(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  if (updatesGolden()) std::ofstream(goldenFile(name)) << toHexLines(bytes);
  EXPECT_EQ(toHexLines(bytes), toHexLines(readGolden(name))) << name;
}

/// Returns the bytes of the first code block behind the line `mark` of a page.
inline std::vector<std::uint8_t> readBlockBehind(const std::filesystem::path& page,
                                                 const std::string& mark) {
  std::ifstream in(page);
  std::vector<std::uint8_t> bytes;
  std::string line;
  while (std::getline(in, line) && line != mark) {
  }
  while (std::getline(in, line) && line != "```") {
  }
  while (std::getline(in, line) && line != "```") appendBytesOfLine(line, bytes);
  return bytes;
}

/// Returns whether a page has this text in one line.
inline bool pageHas(const std::filesystem::path& page, const std::string& text) {
  std::ifstream in(page);
  for (std::string line; std::getline(in, line);) {
    if (line.find(text) != std::string::npos) return true;
  }
  return false;
}

}  // namespace hapticast::testing
