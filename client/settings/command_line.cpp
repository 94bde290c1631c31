// SPDX-License-Identifier: MIT
#include "client/settings/command_line.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "client/device/falcon/falcon_settings.hpp"
#include "client/device/open_device.hpp"
#include "client/settings/control_request.hpp"
#include "client/settings/settings.hpp"
#include "client/settings/study_options.hpp"
#include "client/trust/server_trust.hpp"
#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::client {

namespace {

// The package hapticast-client installs it.
constexpr const char* kSystemConfig = "/etc/hapticast/client.conf";

const std::map<std::string, SurfaceKind> kSurfaceKinds{{"proxy", SurfaceKind::kProxy},
                                                       {"normal", SurfaceKind::kNormal},
                                                       {"perturbed", SurfaceKind::kPerturbed}};
const std::map<std::string, Method> kMethods{{"hapticast", Method::kHapticast},
                                             {"thesis", Method::kThesis}};
const std::map<std::string, Transport> kTransports{
    {transportName(Transport::kDatagrams), Transport::kDatagrams},
    {transportName(Transport::kTcp), Transport::kTcp},
    {transportName(Transport::kGroup), Transport::kGroup}};

const std::map<std::string, ViewChoice> kViews{
    {"auto", ViewChoice::kAuto}, {"on", ViewChoice::kOn}, {"off", ViewChoice::kOff}};
const std::map<std::string, Forces> kForces{
    {"both", Forces::kBoth}, {"static", Forces::kStatic}, {"dynamic", Forces::kDynamic}};

/// What --device takes: auto, and the kinds of this build.
const std::map<std::string, std::string>& devices() {
  static const auto kDevices = [] {
    std::map<std::string, std::string> names{{"auto", "auto"}};
    for (const std::string& name : deviceNames()) names.emplace(name, name);
    return names;
  }();
  return kDevices;
}

/// Returns a hint for the name of a product, for example "omni".
std::string productHint(const std::string& text) {
  const std::string word = " " + toLower(text) + " ";
  for (const DeviceKind& kind : deviceKinds()) {
    if ((" " + std::string(kind.products)).find(word) != std::string::npos)
      return std::string("; did you mean ") + kind.name + "?";
  }
  return "";
}

std::string deviceHelp() {
  std::string help =
      "The haptic device; auto (default): a connected device, else the mouse if there is a window, "
      "else virtual";
  for (const DeviceKind& kind : deviceKinds()) {
    help += std::string("; ") + kind.name + ": " + kind.description;
  }
  return help;
}

/// For --version: the kinds of views, devices and transports of this build.
std::string listOptionalParts() {
  std::string text = "views: screenshot film";
  if (kHasSound) text += " sound";
  text += kHasWindow ? " window; devices:" : "; devices:";
  for (const DeviceKind& kind : deviceKinds()) text += std::string(" ") + kind.name;
  text += "; transports:";
  for (const auto& transport : kTransports) text += " " + transport.first;
  return text.append(kHasDiscovery ? "; discovery: Avahi" : "; discovery: none");
}

/// Adds the flags of trust between client and server.
void addTrust(CLI::App& app, Settings& settings) {
  app.add_option("--tls-ca", settings.tls_ca_file,
                 "With hapticasts://: accept only servers whose certificate is of an authority in "
                 "this file (PEM). Default: the key of the first connection, which the client "
                 "stores in hapticast/known_servers in $XDG_STATE_HOME, else in ~/.local/state")
      ->type_name("FILE");
  app.add_option("--token-file", settings.token_file,
                 "The file with the access token for the server")
      ->type_name("FILE");
  const auto set_control = [&settings](const std::string& request) {
    settings.control = parseControl(request);
    if (!settings.control) {
      throw CLI::ValidationError("--control", quote(request) +
                                                  " is not pause, play, seek=SECONDS or "
                                                  "stiffness|damping|texture-depth|mass=NUMBER or "
                                                  "friction=STATIC:DYNAMIC, joined by commas");
    }
  };
  app.add_option_function<std::string>(
         "--control", set_control,
         "As an operator (--token-file): send this request to the server, and end. pause, play, "
         "seek=SECONDS, speed=FACTOR (0.1..4, of a recording), stiffness=, damping=, "
         "texture-depth=, mass=, friction=STATIC:DYNAMIC")
      ->type_name("REQUEST[,...]");
  app.add_flag("--insecure", settings.insecure,
               "Send the access token to other machines without TLS, too");
}

void addServer(CLI::App& app, Settings& settings) {
  const auto set = [&settings](const std::string& text) { setServer(settings, text); };
  app.add_option_function<std::string>(
         "server", set,
         "The address of hapticast-server, or mdns:NAME for the server announced as NAME. Default: "
         "localhost:7447; while no server answers there, the log lists the servers on the LAN. The "
         "client waits until the server answers")
      ->type_name(kServerForm);
  addList(app, "--origin-key", settings.origin_keys, parseOriginKey,
          "The public key of the server, in hex; the client ends if the server shows another one. "
          "May appear more than once. The word first: the key of the first connection, which the "
          "client stores in hapticast/known_origins in $XDG_STATE_HOME, else in ~/.local/state. "
          "Default: any key",
          "KEY|first (64 hex digits of the server's public key, or first)");
  app.add_flag("--list", settings.list_servers,
               "List the servers that are announced on the LAN, and end: with exit code 0, or 1 if "
               "there is none")
      ->each([](const std::string& /*value*/) { requireDiscovery("--list"); });
}

void addDriverOption(CLI::App& app, Settings& settings) {
  const auto add = [&settings](const std::string& text) {
    const std::size_t split = text.find('=');
    if (split == 0 || split == std::string::npos)
      throw CLI::ValidationError("--device-option", quote(text) + " is not KEY=VALUE");
    settings.device_options[text.substr(0, split)] = text.substr(split + 1);
  };
  app.add_option_function<std::vector<std::string>>(
         "--device-option",
         [add](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) add(text);
         },
         "A setting for the driver of the device; `serial` selects one of several devices. "
         "DRIVER.KEY=VALUE is for this driver only, e.g. falcon.gain=3500")
      ->type_name("[DRIVER.]KEY=VALUE");
}

void addDeviceOptions(CLI::App& app, Settings& settings) {
  addChoice(app, "--device", settings.device, devices(), deviceHelp(), productHint);
  addDriverOption(app, settings);
  app.add_option("--profile", settings.profile,
                 "The limits of the device: omni (default), falcon, or a file "
                 "of KEY = VALUE lines (keys: client/device/README.md, Profiles)")
      ->type_name("NAME|FILE")
      ->default_str(settings.profile);
  app.add_option(
         "--hand", settings.hand,
         "The motion of the virtual hand: press (default; push with 1 N, hold, release, "
         "repeat), slide (over the object, 1 mm deep), follow (move with the object), free "
         "(nobody holds the grip), or a CSV file of t_s,x_mm,y_mm,z_mm targets in nominal mm")
      ->each([&settings](const std::string& /*name*/) { settings.hand_given = true; })
      ->type_name("press|slide|follow|free|FILE.csv")
      ->default_str(settings.hand);
  addNumber(app, "--stiffness-limit", settings.stiffness_limit_N_mm, 0.01, 1000.0, "N/MM",
            "The largest stiffness that an author may request; default: three times the profile's "
            "stiffness");
  app.add_flag("--rearm", settings.rearm,
               "The force fades in automatically after a lost device answers again, or 5 s after "
               "the trust in a stream was lost (three times at most); without this flag, only R in "
               "the window or the next start restores it");
}

bool hasDevice(std::string_view name) {
  const auto kinds = deviceKinds();
  return std::any_of(kinds.begin(), kinds.end(),
                     [name](const DeviceKind& kind) { return kind.name == name; });
}

/// Adds --falcon-KEY VALUE, which is --device-option falcon.KEY=VALUE. `check` throws for a wrong
/// value.
CLI::Option* addFalconOption(CLI::App& app, Settings& settings, const std::string& key,
                             const char* type, const char* help,
                             const std::function<void(const std::string& text)>& check = {}) {
  const auto set = [&settings, key, check](const std::string& text) {
    if (check) check(text);
    settings.device_options["falcon." + key] = text;
  };
  return app.add_option_function<std::string>("--falcon-" + key, set, help)->type_name(type);
}

void checkFalconGain(const std::string& text) {
  if (!parseFalconGain(text))
    throw notANumber("--falcon-gain", text, kLeastFalconGain, kMostFalconGain);
}

void addFalconOptions(CLI::App& app, Settings& settings) {
  app.add_flag("--list-devices", settings.list_devices,
               "List the kinds of devices and the connected devices, and end");
  addChoice(app, "--check-device", settings.check_device, devices(),
            "Check that the motion of a device follows its commands and fits its profile (mass, "
            "delay, count), and end. Let go of the grip: it is pushed with 0.3 N",
            productHint);
  if (!hasDevice("falcon")) return;
  addFalconOption(app, settings, "firmware", "FILE",
                  "The Falcon's firmware, a file of your own, loaded after each power-up; default: "
                  "hapticast/falcon.bin in $XDG_DATA_HOME, else in ~/.local/share");
  addFalconOption(app, settings, "serial", "S",
                  "Which Falcon, by its serial number (--list-devices); default: the first");
  showDefault(*addFalconOption(app, settings, "gain", "COUNTS_PER_NM",
                               "Motor counts for a torque of 1 N m at an arm of the Falcon, "
                               "100..20000; default: 3500",
                               checkFalconGain),
              kFalconGain);
  addNumber(app, "--falcon-calibrate", settings.calibration_g, 50.0, 500.0, "GRAMS",
            "Measure the gain with a known weight, step by step, and end; the file of --config "
            "stores the gain, else the log shows it");
}

void addDeliveryOptions(CLI::App& app, DeliverySettings& delivery) {
  addChoice(app, "--transport", delivery.best, kTransports,
            "The transport of the frames: udp (default), tcp, or multicast if the server sends to "
            "a group. If a transport fails, the client falls back from multicast to udp and from "
            "udp to tcp, and tries again every 30 s");
  const auto set = [&delivery](const std::string& text) {
    const auto copies = parseNumberInRange<std::uint64_t>(text, 1, limits::kMostCopies);
    if (text != "auto" && !copies)
      throw CLI::ValidationError("--redundancy", quote(text) + " is not auto or 1..4");
    delivery.copies = static_cast<std::uint32_t>(copies.value_or(0));
  };
  app.add_option_function<std::string>("--redundancy", set,
                                       "The number of sends of each datagram, one frame apart: "
                                       "auto (default; follows the network's loss), or 1..4")
      ->type_name("auto|N")
      ->default_str("auto");
  app.add_option("--interface", delivery.interface_name,
                 "The network interface that joins a multicast group, by name or address; default: "
                 "the interface of the route to the server")
      ->type_name("NAME|ADDRESS");
}

void addMaxDelay(CLI::App& app, Settings& settings) {
  addNumber(app, "--max-delay", settings.max_delay_ms, 20.0, 2000.0, "MS",
            "The largest playout delay; default: 2000. The client adapts the delay to the network. "
            "A stream that needs more counts as interrupted: the force fades");
}

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

void addOutputOptions(CLI::App& app, Settings& settings) {
  addFile(app, "--screenshot", settings.screenshot_file, ".png",
          "Write a picture at the end: the video with cone and forces at the strongest moment, and "
          "the force of the last minute");
  addFile(app, "--film", settings.film_file, ".mp4",
          "Write a film: the video with cone and forces, and the force of the last seconds, at the "
          "video's rate");
  app.add_option("--log", settings.log_file,
                 "Write a row per tick: t_s,media_s, HIP x,y,z_mm (nominal), force f, s (static), "
                 "d (dynamic) in N, "
                 "penetration_mm,lookup, predicted HIP ahead_x,y,z_mm")
      ->type_name("FILE.csv");
  app.add_option("--summary", settings.summary_file,
                 "Write counters, tick times and extremes at the end")
      ->type_name("FILE.json");
  app.add_option("--fault-dir", settings.fault_folder,
                 "The folder for the ticks before a fault; default: hapticast in $XDG_STATE_HOME, "
                 "else in ~/.local/state")
      ->type_name("DIR");
  addFile(app, "--record", settings.outputs.record, ".mcap",
          "Record the run in a new file: every tick, the received frames and pictures");
  addLive(app, settings.outputs.live);
  addNumber(app, "--seconds", settings.seconds, 0.001, 1e9, "S",
            "Stop S seconds after the first frame, or if none arrives for S seconds; default: at "
            "Ctrl-C");
  app.add_flag("--quiet", settings.quiet, "Only warnings and errors");
}

/// Adds --replay and --stiffness. Sets the settings that replace the recorded ones.
void addReplayOptions(CLI::App& app, Settings& settings) {
  addFile(app, "--replay", settings.replay_file, ".mcap",
          "Render a recorded run again, as fast as it can be, and end. The forces have the same "
          "bits; --stiffness, --method, --surface and --stiffness-limit change them. --log, "
          "--record, --film and --screenshot write files of it");
  addNumber(app, "--stiffness", settings.stiffness_N_mm, 0.01, 10.0, "N/mm",
            "With --replay: the stiffness of all surfaces; default: as recorded");
  app.final_callback([&settings, parsed = &app] {
    if (!settings.replay_file.empty() && settings.outputs.live)
      throw CLI::ValidationError("--live", "--replay does not run in real time; record it");
    if (settings.replay_file.empty() && settings.stiffness_N_mm > 0.0)
      throw CLI::ValidationError("--stiffness", "needs --replay");
    requireStudyOptions(settings.study);
    settings.method_given = parsed->count("--method") > 0;
    settings.surface_given = parsed->count("--surface") > 0;
  });
}

}  // namespace

void setServer(Settings& settings, const std::string& text) {
  if (parseServer(text, settings)) {
    if (!settings.announced.empty()) requireDiscovery("server");
    return;
  }
  if (!settings.announced.empty()) (void)serviceName("server", settings.announced);
  throw CLI::ValidationError("server", quote(text) +
                                           " is not HOST[:PORT], PORT, [V6ADDRESS]:PORT, "
                                           "hapticasts://HOST or mdns:NAME (port 1..65535)");
}

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Lets a haptic device touch the objects that hapticast-server streams. Ctrl-C ends the "
      "client with the force at zero.",
      "hapticast-client");
  addVersion(*app, listOptionalParts());
  addServer(*app, settings);
  addTrust(*app, settings);
  addDeviceOptions(*app, settings);
  addFalconOptions(*app, settings);
  addDeliveryOptions(*app, settings.delivery);
  addMaxDelay(*app, settings);
  addChoice(*app, "--surface", settings.surface, kSurfaceKinds,
            "proxy (default): a surface point that a spring ties to the tip, with walls and "
            "friction; normal: distance to the tangent plane; perturbed: the thesis's Eq. 3");
  addChoice(*app, "--method", settings.method, kMethods,
            "hapticast, or as in the thesis: perturbed surface, zero outside the mask, forces "
            "interpolated by cubics");
  addViewOptions(*app, settings);
  addOutputOptions(*app, settings);
  addReplayOptions(*app, settings);
  addStudyOptions(*app, settings.study);
  addConfigFile(*app, kSystemConfig);
  return app;
}

std::optional<int> readCommandLine(Settings& settings, int argc, const char* const* argv) {
  const auto app = commandLine(settings);
  const auto exit_code = parseCommandLine(*app, argc, argv);
  if (exit_code) return exit_code;
  const std::string config = app->get_config_ptr()->as<std::string>();
  if (config != kSystemConfig) settings.config_file = config;
  return std::nullopt;
}

void requireVirtualHand(const Settings& settings) {
  if (!settings.hand_given || settings.device == "auto" || settings.device == "virtual") return;
  throw std::runtime_error("--hand " + settings.hand +
                           ": moves only the virtual device, but --device is " + settings.device +
                           "; remove --hand, or use --device virtual");
}

}  // namespace hapticast::client
