// SPDX-License-Identifier: MIT
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>
#include <memory>

#include "client/app.hpp"
#include "client/open_views.hpp"
#include "client/settings.hpp"
#include "common/cli/parse.hpp"

namespace {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongInput = 2 };

int touch(const hapticast::client::Settings& settings) {
  const hapticast::SteadyClock clock;
  std::unique_ptr<hapticast::client::App> app;
  try {
    app = std::make_unique<hapticast::client::App>(settings, clock,
                                                   hapticast::client::openViews(settings));
  } catch (const hapticast::client::DeviceAbsent& error) {
    spdlog::error("{}", hapticast::oneLine(error.what()));
    return kFailed;
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::oneLine(error.what()));
    return kWrongInput;
  }
  return app->run() ? kDone : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::client::Settings settings;
  const auto command_line = hapticast::client::commandLine(settings);
  if (const auto exit_code = hapticast::parseCommandLine(*command_line, argc, argv))
    return *exit_code;
  if (settings.list_devices) {
    std::fputs(hapticast::client::listDevices().c_str(), stdout);
    return kDone;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("hapticast-client"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  if (settings.quiet) spdlog::set_level(spdlog::level::warn);
  try {
    return touch(settings);
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::oneLine(error.what()));
    return kFailed;
  }
}
