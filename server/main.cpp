// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "common/cli/run_program.hpp"
#include "common/recording/recorder.hpp"
#include "common/text.hpp"
#include "server/bake/bake.hpp"
#include "server/preview/preview.hpp"
#include "server/settings/command_line.hpp"
#include "server/show/app.hpp"
#include "server/show/edge.hpp"
#include "server/show/play_on_demand.hpp"
#include "server/show/play_recording.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/stream/key_file.hpp"
#include "server/stream/stream_settings.hpp"
#include "server/vision/vision.hpp"

namespace {

using hapticast::kDone;
using hapticast::kFailed;
using hapticast::kWrongInput;
using hapticast::server::Command;

/// Calls `run`, and turns errors of the input into a line of the log and an exit code. `streaming`
/// returns whether a later error is a failure at run time. `flag`: names the source.
template <class Run, class Streaming>
int runReporting(const char* flag, const Run& run, const Streaming& streaming) {
  try {
    return run();
  } catch (const hapticast::server::SourceError& error) {
    const std::string what = hapticast::sanitizeUtf8(error.what());
    // Some messages are about another flag and begin with it.
    spdlog::error("{}{}", what.starts_with("--") ? "" : flag, what);
    return streaming() ? kFailed : kWrongInput;
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
}

/// Serves viewers until the end of the stream or a signal. `app`: that of a clip.
void serve(const hapticast::server::Settings& settings, const hapticast::Clock& clock,
           hapticast::server::ReadSettings reread, std::unique_ptr<hapticast::server::App>& app) {
  if (settings.command == Command::kRelay)
    return hapticast::server::runEdge(settings, clock, std::move(reread));
  if (settings.on_demand)
    return hapticast::server::playOnDemand(settings, clock, std::move(reread));
  if (settings.is_recording)
    return hapticast::server::playRecording(settings, clock, std::move(reread));
  app = std::make_unique<hapticast::server::App>(settings, clock, std::move(reread));
  app->run();
}

int runCommand(const hapticast::server::Settings& settings,
               hapticast::server::ReadSettings reread) {
  const hapticast::SteadyClock clock;
  if (settings.command == Command::kBake) {
    bool started = false;
    return runReporting(
        "bake ", [&] { return hapticast::server::bake(settings, clock, started); },
        [&] { return started; });
  }
  std::unique_ptr<hapticast::server::App> app;
  const auto run = [&]() -> int {
    if (settings.command == Command::kPreview) {
      hapticast::server::writePreview(settings, clock);
    } else {
      serve(settings, clock, std::move(reread), app);
    }
    return kDone;
  };
  return runReporting("--source ", run, [&] { return app && app->streaming(); });
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::server::stopOpenCvThreads();
  hapticast::server::Settings settings;
  if (const auto exit_code = hapticast::server::readCommandLine(settings, argc, argv))
    return *exit_code;
  const auto reread = [argc, argv] { return hapticast::server::rereadCommandLine(argc, argv); };
  return hapticast::runProgram(settings.quiet, [&] { return runCommand(settings, reread); });
}
