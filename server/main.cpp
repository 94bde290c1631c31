// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/cli/run_program.hpp"
#include "common/recording/recorder.hpp"
#include "common/text.hpp"
#include "server/preview/preview.hpp"
#include "server/settings/command_line.hpp"
#include "server/show/producers.hpp"
#include "server/show/show.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/stream/key_file.hpp"
#include "server/stream/stream_settings.hpp"
#include "server/vision/vision.hpp"

namespace {

using hapticast::kDone;
using hapticast::kFailed;
using hapticast::kWrongInput;
using hapticast::server::Command;
using hapticast::server::Producer;

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

std::unique_ptr<Producer> openProducer(const hapticast::server::Settings& settings,
                                       const hapticast::Clock& clock) {
  if (settings.command == Command::kBake)
    return hapticast::server::makeBakeProducer(settings, clock);
  if (settings.command == Command::kRelay)
    return hapticast::server::makeEdgeProducer(settings, clock);
  if (settings.on_demand) return hapticast::server::makeOnDemandProducer(settings, clock);
  if (settings.is_recording) return hapticast::server::makeRecordingProducer(settings, clock);
  return hapticast::server::makeClipProducer(settings, clock);
}

int runCommand(const hapticast::server::Settings& settings,
               hapticast::server::ReadSettings reread) {
  const hapticast::SteadyClock clock;
  std::unique_ptr<Producer> producer;
  std::optional<hapticast::server::Show> show;
  const auto run = [&]() -> int {
    if (settings.command == Command::kPreview) {
      hapticast::server::writePreview(settings, clock);
      return kDone;
    }
    producer = openProducer(settings, clock);
    return show.emplace(settings, clock, std::move(reread), *producer).run() ? kDone : kFailed;
  };
  return runReporting(settings.command == Command::kBake ? "bake " : "--source ", run,
                      [&] { return show && show->streaming(); });
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
