// SPDX-License-Identifier: MIT
#include "common/write_file.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace hapticast {

std::optional<Error> writeFile(const std::string& file, std::span<const unsigned char> bytes) {
  const auto fail = [](int number) {
    return Error{"cannot be written (" + std::system_category().message(number) + ")"};
  };
  std::FILE* const out = std::fopen(file.c_str(), "wbe");
  if (out == nullptr) return fail(errno);
  errno = 0;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
  const int number = errno;
  if (std::fclose(out) == 0 && written) return std::nullopt;  // fclose() writes the rest
  const int reason = written ? errno : number;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
  return fail(reason);
}

void requireWritable(const char* flag, const std::string& file) {
  if (file.empty() || std::ofstream(file, std::ios::app)) return;
  throw std::runtime_error(std::string(flag) + " " + file +
                           ": cannot be written; is its folder there and writable?");
}

}  // namespace hapticast
