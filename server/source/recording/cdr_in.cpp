// SPDX-License-Identifier: MIT
#include "server/source/recording/cdr_in.hpp"

namespace hapticast::server {

CdrIn::CdrIn(std::span<const std::uint8_t> message) {
  constexpr std::size_t kHeadBytes = 4;
  if (message.size() < kHeadBytes) {
    fail();
  } else if (message[0] != 0 || message[1] > 1) {
    problem_ = "has a message that is not in the form CDR 1 of ROS 2";
  } else {
    content_ = message.subspan(kHeadBytes);
    big_endian_ = message[1] == 0;
  }
}

void CdrIn::fail() {
  if (problem_.empty()) problem_ = "has a message that is cut off";
  content_ = {};
  at_ = 0;
}

std::span<const std::uint8_t> CdrIn::take(std::size_t count) {
  if (!problem_.empty() || count > content_.size() - at_) {
    fail();
    return {};
  }
  const auto taken = content_.subspan(at_, count);
  at_ += count;
  return taken;
}

std::uint64_t CdrIn::number(std::size_t size) {
  (void)take((size - at_ % size) % size);
  const auto bytes = take(size);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    value = value << 8U | bytes[big_endian_ ? i : bytes.size() - 1 - i];
  return value;
}

std::string_view CdrIn::text() {
  const auto taken = take(uint32());
  const std::string_view text(reinterpret_cast<const char*>(taken.data()), taken.size());
  return text.substr(0, text.find('\0'));
}

void CdrIn::skipFloats() {
  const std::uint32_t count = uint32();
  if (count == 0) return;
  (void)float64();
  (void)take(std::size_t{8} * (count - 1));
}

}  // namespace hapticast::server
