// SPDX-License-Identifier: MIT
#include "server/source/folder/frame_number.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace hapticast::server {

std::optional<std::uint64_t> frameNumber(const std::filesystem::path& image) {
  constexpr std::size_t kMostDigits = 9;
  const std::string name = image.stem().string();
  const auto isDigit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const auto end = std::find_if(name.rbegin(), name.rend(), isDigit);
  const auto begin = std::find_if_not(end, name.rend(), isDigit);
  const std::string digits(begin.base(), end.base());
  if (digits.empty() || digits.size() > kMostDigits || name.find('.') != std::string::npos)
    return std::nullopt;
  return std::stoull(digits);
}

}  // namespace hapticast::server
