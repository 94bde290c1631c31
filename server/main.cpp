// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "common/cli/run_program.hpp"
#include "common/recording/recorder.hpp"
#include "common/text.hpp"
#include "server/app.hpp"
#include "server/command_line.hpp"
#include "server/edge.hpp"
#include "server/play_recording.hpp"
#include "server/preview/preview.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/stream/key_file.hpp"
#include "server/stream/stream_settings.hpp"

namespace {

using hapticast::kDone;
using hapticast::kFailed;
using hapticast::kWrongInput;

int serve(const hapticast::server::Settings& settings, hapticast::server::ReadSettings reread) {
  const hapticast::SteadyClock clock;
  std::unique_ptr<hapticast::server::App> app;
  try {
    if (!settings.preview.empty()) {
      hapticast::server::writePreview(settings, clock);
      return kDone;
    }
    if (hapticast::server::isEdge(settings)) {
      hapticast::server::runEdge(settings, clock, std::move(reread));
      return kDone;
    }
    if (hapticast::server::isRecording(settings)) {
      hapticast::server::playRecording(settings, clock, std::move(reread));
      return kDone;
    }
    app = std::make_unique<hapticast::server::App>(settings, clock, std::move(reread));
    app->run();
  } catch (const hapticast::server::SourceError& error) {
    const std::string what = hapticast::sanitizeUtf8(error.what());
    // Some messages are about another flag and begin with it.
    spdlog::error("{}{}", what.starts_with("--") ? "" : "--source ", what);
    return app && app->streaming() ? kFailed : kWrongInput;
  } catch (const hapticast::AddressError& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  } catch (const hapticast::server::KeyFileError& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  } catch (const hapticast::RecordingError& error) {
    spdlog::error("{}", hapticast::sanitizeUtf8(error.what()));
    return kWrongInput;
  }
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::server::Settings settings;
  if (const auto exit_code = hapticast::server::readCommandLine(settings, argc, argv))
    return *exit_code;
  const auto reread = [argc, argv] { return hapticast::server::rereadCommandLine(argc, argv); };
  return hapticast::runProgram(settings.quiet, [&] { return serve(settings, reread); });
}
