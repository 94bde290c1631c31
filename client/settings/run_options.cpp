// SPDX-License-Identifier: MIT
// The subcommands that render forces: touch, replay and study.
#include <map>
#include <string>

#include "client/settings/device_options.hpp"
#include "client/settings/server_options.hpp"
#include "client/settings/subcommand_options.hpp"
#include "client/study/simulated_observer.hpp"
#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/cli/subcommands.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

const std::map<std::string, SurfaceKind> kSurfaceKinds{{"proxy", SurfaceKind::kProxy},
                                                       {"normal", SurfaceKind::kNormal},
                                                       {"perturbed", SurfaceKind::kPerturbed}};
const std::map<std::string, Method> kMethods{{"hapticast", Method::kHapticast},
                                             {"thesis", Method::kThesis}};
const std::map<std::string, ViewChoice> kViews{
    {"auto", ViewChoice::kAuto}, {"on", ViewChoice::kOn}, {"off", ViewChoice::kOff}};
const std::map<std::string, Forces> kForces{
    {"both", Forces::kBoth}, {"static", Forces::kStatic}, {"dynamic", Forces::kDynamic}};

void addViewOptions(CLI::App& app, Settings& settings) {
  addChoice(app, "--view", settings.view, kViews,
            "The window: auto (default; on if there is a display and none of --hand, --seconds, "
            "--screenshot is set), on, or off. F1 in the window lists the keys");
  app.add_flag("--fullscreen", settings.fullscreen,
               "The window fills the screen; F11 changes that");
  addChoice(app, "--forces", settings.forces, kForces,
            "The rendered forces: both (default), static or dynamic; S and D in the window");
  if (kHasSound) {
    app.add_flag(
        "--sound", settings.sound,
        "Play the force as sound: a hum as loud as the force is strong, a tick at a sudden change");
  }
}

void addMethodOptions(CLI::App& app, Settings& settings) {
  addChoice(app, "--surface", settings.surface, kSurfaceKinds,
            "proxy (default): a surface point that a spring ties to the tip, with walls and "
            "friction; normal: distance to the tangent plane; perturbed: the thesis's Eq. 3");
  addChoice(app, "--method", settings.method, kMethods,
            "hapticast, or as in the thesis: perturbed surface, zero outside the mask, forces "
            "interpolated by cubics");
}

void addPictureFiles(CLI::App& app, Settings& settings) {
  addFile(app, "--screenshot", settings.screenshot_file, ".png",
          "Write a picture at the end: the video with cone and forces at the strongest moment, and "
          "the force of the last minute");
  addFile(app, "--film", settings.film_file, ".mp4",
          "Write a film: the video with cone and forces, and the force of the last seconds, at the "
          "video's rate");
}

void addLog(CLI::App& app, Settings& settings) {
  app.add_option("--log", settings.log_file,
                 "Write a row per tick: t_s,media_s, HIP x,y,z_mm (nominal), force f, s (static), "
                 "d (dynamic) in N, "
                 "penetration_mm,lookup, predicted HIP ahead_x,y,z_mm")
      ->type_name("FILE.csv");
}

void addRecord(CLI::App& app, Settings& settings) {
  addFile(app, "--record", settings.outputs.record, ".mcap",
          "Record the run in a new file: every tick, the received frames and pictures");
}

/// Adds the flags of a run with a person at the device.
void addRunOptions(CLI::App& app, Settings& settings) {
  addServerOptions(app, settings);
  addDeviceOptions(app, settings);
  addDeliveryOptions(app, settings);
  addViewOptions(app, settings);
  addPictureFiles(app, settings);
  addLog(app, settings);
  app.add_option("--fault-dir", settings.fault_folder,
                 "The folder for the ticks before a fault; default: hapticast in $XDG_STATE_HOME, "
                 "else in ~/.local/state")
      ->type_name("DIR");
  addLive(app, settings.outputs.live);
}

void addStudyOptions(CLI::App& app, StudySettings& study) {
  app.add_option("FILE,--study", study.file, "The trials")->type_name("FILE.json")->required();
  app.add_option("--subject", study.subject, "The code of the subject: letters and digits, no name")
      ->type_name("CODE")
      ->required();
  app.add_option("--out", study.out, "The folder of the results, a dataset of BIDS 1.9 (Motion)")
      ->type_name("DIR")
      ->required();
  app.add_flag("--resume", study.resume, "Continue the interrupted study of this subject");
  const auto set = [&study](const std::string& text) {
    study.simulate = parseObserver(text);
    if (!study.simulate)
      throw CLI::ValidationError("--simulate",
                                 quote(text) + " is not threshold=T[,slope=S][,lapse=L]");
  };
  app.add_option_function<std::string>(
         "--simulate", set,
         "A simulated observer answers in place of a subject: in a forced choice by a psychometric "
         "function, on a scale at random")
      ->type_name("threshold=T[,slope=S][,lapse=L]");
  const auto set_markers = [&study](const std::string& text) {
    study.markers = parseEndpointOr(text, {"localhost", 0}, "--markers", 1, "HOST:PORT");
  };
  app.add_option_function<std::string>(
         "--markers", set_markers,
         "Send a line as a UDP datagram to this address at each event of the study (for an EEG)")
      ->type_name("HOST:PORT");
}

}  // namespace

void addTouchCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(program, "touch",
                                "Touch the objects of a stream. This is what a command without a "
                                "subcommand does");
  addRunOptions(app, settings);
  addMethodOptions(app, settings);
  app.add_option("--summary", settings.summary_file,
                 "Write counters, tick times and extremes at the end")
      ->type_name("FILE.json");
  addRecord(app, settings);
  addNumber(app, "--seconds", settings.seconds, 0.001, 1e9, "S",
            "Stop S seconds after the first frame, or if none arrives for S seconds; default: at "
            "Ctrl-C");
  app.final_callback([&settings] { settings.command = Command::kTouch; });
}

void addReplayCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(
      program, "replay",
      "Render a recorded run again, as fast as it can be. The forces have the same bits; "
      "--stiffness, --method, --surface and --stiffness-limit change them");
  addFile(app, "FILE,--replay", settings.replay_file, ".mcap", "The recording of --record")
      ->required();
  addNumber(app, "--stiffness", settings.stiffness_N_mm, 0.01, 10.0, "N/mm",
            "The stiffness of all surfaces; default: as recorded");
  addMethodOptions(app, settings);
  addStiffnessLimit(app, settings);
  addPictureFiles(app, settings);
  addLog(app, settings);
  addRecord(app, settings);
  app.final_callback([&settings, &app] {
    settings.command = Command::kReplay;
    settings.method_given = app.count("--method") > 0;
    settings.surface_given = app.count("--surface") > 0;
  });
}

void addStudyCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(
      program, "study", "Run a study with people: the trials of a file (client/study/README.md)");
  addStudyOptions(app, settings.study);
  addRunOptions(app, settings);
  app.final_callback([&settings] { settings.command = Command::kStudy; });
}

}  // namespace hapticast::client
