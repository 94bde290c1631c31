// SPDX-License-Identifier: MIT
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <string>

#include "common/cli/parse.hpp"
#include "server/app.hpp"
#include "server/command_line.hpp"
#include "server/preview/preview.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/stream/address_error.hpp"

namespace {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongInput = 2 };

int serve(const hapticast::server::Settings& settings) {
  const hapticast::SteadyClock clock;
  std::unique_ptr<hapticast::server::App> app;
  try {
    if (!settings.preview.empty()) {
      hapticast::server::writePreview(settings, clock);
      return kDone;
    }
    app = std::make_unique<hapticast::server::App>(settings, clock);
    app->run();
  } catch (const hapticast::server::SourceError& error) {
    const std::string what = hapticast::stripControls(error.what());
    // Some messages are about another flag and begin with it.
    spdlog::error("{}{}", what.starts_with("--") ? "" : "--source ", what);
    return app && app->streaming() ? kFailed : kWrongInput;
  } catch (const hapticast::server::AddressError& error) {
    const std::string what = hapticast::stripControls(error.what());
    spdlog::error("{}{}", what.starts_with("--") ? "" : "--listen: ", what);
    return kWrongInput;
  }
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::server::Settings settings;
  if (const auto exit_code = hapticast::server::readCommandLine(settings, argc, argv))
    return *exit_code;
  spdlog::set_default_logger(spdlog::stderr_color_mt("hapticast-server"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  if (settings.quiet) spdlog::set_level(spdlog::level::warn);
  try {
    return serve(settings);
  } catch (const std::exception& error) {
    spdlog::error("{}", hapticast::stripControls(error.what()));
    return kFailed;
  }
}
