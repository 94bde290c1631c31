// SPDX-License-Identifier: MIT
#include "server/stream/limited_log.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace hapticast::server {

void LimitedLog::info(std::string line) { log(spdlog::level::info, std::move(line)); }

void LimitedLog::warn(std::string line) { log(spdlog::level::warn, std::move(line)); }

void LimitedLog::error(std::string line) { log(spdlog::level::err, std::move(line)); }

void LimitedLog::log(spdlog::level::level_enum level, std::string line) {
  RateLimiter& limit = level >= spdlog::level::warn ? problems_ : others_;
  if (const auto admitted = limit.admit(std::move(line), clock_.now()))
    spdlog::log(level, "{}", *admitted);
}

}  // namespace hapticast::server
