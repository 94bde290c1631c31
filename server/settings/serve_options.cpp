// SPDX-License-Identifier: MIT
// The subcommands of a server with viewers: serve and relay.
#include "server/settings/subcommand_options.hpp"

#include <filesystem>
#include <string>
#include <system_error>

#include "common/cli/options.hpp"
#include "common/cli/subcommands.hpp"
#include "common/recording/mcap_reader.hpp"
#include "common/recording/progress_log.hpp"
#include "common/text.hpp"
#include "server/author/author_options.hpp"
#include "server/settings/clip_options.hpp"
#include "server/settings/network_options.hpp"

namespace hapticast::server {

namespace {

void addSource(CLI::App& app, std::string& source) {
  app.add_option(
         "SOURCE,--source", source,
         "The video to stream: synthetic:bounce|approach|tumble|still, a folder of RGB-D images "
         "(rgb/ and depth/, or TUM's rgb.txt and depth.txt), COLOR,DEPTH (two video files; "
         "depth may also be a folder of images or an array NPY, NPZ), FILE (one video file with "
         "colour and depth), camera:N,M (colour camera, depth camera), openni:[DEVICE] (a "
         "camera of OpenNI2), v4l2:COLOR,DEPTH (two nodes of a camera, 16-bit depth), URL (a "
         "live stream with colour and depth: rtsp, rtsps, srt, http, https, udp, tcp or rtp), "
         "or FILE.mcap (a recording that --record has made, or one of ROS 2 or Foxglove with "
         "colour and depth images)")
      ->required();
}

void addPlayOptions(CLI::App& app, Settings& settings) {
  app.add_flag("--loop", settings.loop, "Start again at the end of the clip");
  app.add_flag(
      "--on-demand", settings.on_demand,
      "Each viewer of a recording (SOURCE is FILE.mcap) has a time line of its own: it may "
      "pause, seek and set the speed; by TCP");
  app.add_flag("--wait-for-viewer", settings.wait_for_viewer,
               "Begin to play when the first viewer has joined");
}

void addRecord(CLI::App& app, std::string& record) {
  const auto set = [&record](const std::string& text) {
    if (!hasEnding(text, kRecordingEnding))
      throw CLI::ValidationError("--record", quote(text) + " is not FILE.mcap");
    record = text;
  };
  app.add_option_function<std::string>(
         "--record", set,
         "Record the stream with its pictures in a new file; --source FILE.mcap plays it")
      ->type_name("FILE.mcap");
}

void addPublish(CLI::App& app, Settings& settings) {
  const auto set = [&settings](const std::string& text) {
    settings.publish = parseNatsAddress(text);
    if (!settings.publish)
      throw CLI::ValidationError("--publish", quote(hideUser(text)) + " is not " + kNatsForm);
  };
  app.add_option_function<std::string>(
         "--publish", set,
         "Publish the stream on this channel of NATS, too; edges serve it to their viewers")
      ->type_name(kNatsForm);
  app.add_option("--signing-key", settings.signing_key_file,
                 "The private key (Ed25519, PEM) that signs the frames, so that viewers can expect "
                 "its public key (--origin-key); a FILE that does not exist is created with a new "
                 "key; default: another key in each run")
      ->type_name("FILE");
}

/// Checks the flags that contradict --on-demand. Each viewer then receives by TCP.
void requireOnDemandFlags(const CLI::App& app, Settings& settings) {
  if (!settings.on_demand) return;
  if (!hasEnding(settings.source, kRecordingEnding))
    throw CLI::ValidationError("--on-demand", "needs --source FILE.mcap");
  const bool wants_datagrams = app.count("--transport") > 0 && settings.datagrams;
  settings.datagrams = false;
  if (wants_datagrams) throw CLI::ValidationError("--transport", "--on-demand sends by TCP only");
  for (const char* const name :
       {"--multicast", "--publish", "--record", "--live", "--frames", "--wait-for-viewer"}) {
    if (app.count(name) > 0)
      throw CLI::ValidationError(name, "with --on-demand there is no stream for all viewers");
  }
  if (settings.is_recording) return;
  const auto reader = McapReader::open(settings.source, logScan(settings.source), 1);
  throw CLI::ValidationError("--source", settings.source + ": " +
                                             (reader.ok() ? "is no recording that --record has made"
                                                          : reader.error().message));
}

/// Checks that the source is no slip: a word such as `help`, or an address without --listen.
void requireSource(const std::string& source) {
  std::error_code error;
  if (std::filesystem::exists(source, error)) return;
  if (source == "help") throw CLI::ValidationError("'help'", "is no source; did you mean --help?");
  const auto endpoint = parseEndpoint(source, Endpoint{});
  if (endpoint && (endpoint->host == "localhost" ||
                   endpoint->host.find_first_not_of("0123456789.") == std::string::npos))
    throw CLI::ValidationError(quote(source), "is no source; is --listen missing in front of it?");
}

/// Checks the flags of serve after the parsing.
void finishServe(CLI::App& app, Settings& settings) {
  requireSource(settings.source);
  requireNetworkFlags(settings);
  if (isEdge(settings))
    throw CLI::ValidationError("--source " + hideUser(settings.source),
                               "is a channel of NATS; use hapticast-server relay CHANNEL");
  if (!settings.origin_keys.empty() && !settings.publish)
    throw CLI::ValidationError("--origin-key", "needs --publish, or the subcommand relay");
  settings.is_recording = isRecording(settings);
  if (settings.is_recording) {
    refuseClipOptions(app);
  } else {
    finishClip(app, settings);
  }
  requireOnDemandFlags(app, settings);
}

/// Returns the flags of the subcommand and of the program that were set.
FlagTexts listFlags(const CLI::App& subcommand) {
  FlagTexts flags;
  for (const CLI::App* const app : {&subcommand, subcommand.get_parent()}) {
    for (const CLI::Option* const option : app->get_options()) {
      for (const std::string& text : option->results())
        flags.emplace_back(option->get_lnames().front(), text);
    }
  }
  return flags;
}

}  // namespace

void addServeCommand(CLI::App& program, Settings& settings) {
  CLI::App& app =
      addSubcommand(program, "serve",
                    "Stream a source to viewers. This is what a command without a subcommand does");
  addSource(app, settings.source);
  addPlayOptions(app, settings);
  addFrames(app, settings.frames);
  addName(app, settings.name);
  addRecord(app, settings.outputs.record);
  addLive(app, settings.outputs.live);
  addNetworkOptions(app, settings);
  addPublish(app, settings);
  addNatsOptions(app, settings);
  addClipOptions(app, settings);
  app.final_callback([&settings, &app] {
    settings.command = Command::kServe;
    finishServe(app, settings);
    settings.flags = listFlags(app);
  });
}

void addRelayCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(program, "relay",
                                "An edge: serve viewers the stream that an origin publishes on a "
                                "channel of NATS (serve --publish)");
  app.add_option("CHANNEL,--source", settings.source, "The channel of the origin")
      ->type_name(kNatsForm)
      ->required();
  addNetworkOptions(app, settings);
  addNatsOptions(app, settings);
  app.final_callback([&settings, &app] {
    settings.command = Command::kRelay;
    requireNetworkFlags(settings);
    if (!isEdge(settings))
      throw CLI::ValidationError("--source",
                                 quote(hideUser(settings.source)) + " is not " + kNatsForm);
    settings.flags = listFlags(app);
  });
}

}  // namespace hapticast::server
