// SPDX-License-Identifier: MIT
#include "server/stream/limited_log.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace hapticast::server {

void LimitedLog::info(std::string line) {
  if (const auto admitted = others_.admit(std::move(line), clock_.now()))
    spdlog::info("{}", *admitted);
}

void LimitedLog::warn(std::string line) {
  if (const auto admitted = problems_.admit(std::move(line), clock_.now()))
    spdlog::warn("{}", *admitted);
}

void LimitedLog::error(std::string line) {
  if (const auto admitted = problems_.admit(std::move(line), clock_.now()))
    spdlog::error("{}", *admitted);
}

}  // namespace hapticast::server
