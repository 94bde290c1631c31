// SPDX-License-Identifier: MIT
#include "common/cli/run_program.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <exception>

#include "common/text.hpp"

namespace hapticast {

const char* programVersion() { return HAPTICAST_VERSION; }

void startLog(const std::string& name) {
  spdlog::drop(name);
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
}

int runProgram(bool quiet, const std::function<int()>& run) {
  if (quiet) spdlog::set_level(spdlog::level::warn);
  try {
    return run();
  } catch (const std::exception& error) {
    spdlog::error("{}", sanitizeUtf8(error.what()));
    return kFailed;
  }
}

}  // namespace hapticast
