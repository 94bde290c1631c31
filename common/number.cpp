// SPDX-License-Identifier: MIT
// Numbers in texts (text.hpp). A source of its own, because the C++ library of WebAssembly has no
// std::from_chars() for double.
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "common/text.hpp"

namespace hapticast {

std::optional<double> parseNumber(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

template <class Number>
std::optional<Number> parseNumberInRange(std::string_view text, Number least, Number most) {
  std::optional<Number> value;
  if constexpr (std::is_same_v<Number, double>) {
    value = parseNumber(text);
  } else {
    Number whole{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, whole);
    if (error == std::errc() && stop == end) value = whole;
  }
  return value && *value >= least && *value <= most ? value : std::nullopt;
}
template std::optional<double> parseNumberInRange(std::string_view, double, double);
template std::optional<std::uint16_t> parseNumberInRange(std::string_view, std::uint16_t,
                                                         std::uint16_t);
template std::optional<std::uint64_t> parseNumberInRange(std::string_view, std::uint64_t,
                                                         std::uint64_t);

}  // namespace hapticast
