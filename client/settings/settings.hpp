// SPDX-License-Identifier: MIT
// Settings of hapticast-client and their defaults. command_line.hpp fills them.
// Thread: main; constant after start-up.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/haptics/contact/surface_model.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "client/servers/server_trust.hpp"
#include "client/study/psychometric_function.hpp"
#include "common/endpoint.hpp"
#include "common/live/output_settings.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::client {

/// Choice of --view. kAuto opens a window if there is a display, and if no flag requests a run
/// without a user.
enum class ViewChoice : std::uint8_t { kAuto, kOn, kOff };
/// Choice of --forces: the forces that are on at the start; the user can switch them later. Static:
/// the force of the surface. Dynamic: the force of accelerations and impacts.
enum class Forces : std::uint8_t { kBoth, kStatic, kDynamic };

/// Settings of --study.
struct StudySettings {
  std::string file;  ///< empty: no study
  std::string subject;
  std::string out;  ///< folder of the results
  bool resume = false;
  std::optional<PsychometricFunction> simulate;  ///< an observer answers in place of a subject
  std::optional<Endpoint> markers;               ///< receives a datagram per event
};

/// The subcommand of the program.
enum class Command : std::uint8_t { kTouch, kReplay, kStudy, kCheck, kList, kControl };

struct Settings : ServerSettings {
  Command command = Command::kTouch;
  std::optional<Control> control;  ///< request of an operator
  std::string device = "auto";
  std::string profile;  ///< name of a built-in profile, or a file; empty: the default of the device
  std::map<std::string, std::string> device_options;  ///< of --device-option KEY=VALUE
  bool list_servers = false;  ///< of no use by itself: the flag chooses the subcommand
  bool list_devices = false;
  std::string check_device = "auto";  ///< kind that the subcommand check opens; auto: searches
  double calibration_g = 0.0;         ///< weight of --falcon-calibrate in g; 0: no calibration
  DeliverySettings delivery;
  double max_delay_ms = 2000.0;  ///< largest playout delay
  SurfaceKind surface = SurfaceKind::kProxy;
  std::string hand = "press";  ///< name of a script, or a CSV file
  bool hand_given = false;     ///< the user used --hand
  ViewChoice view = ViewChoice::kAuto;
  bool fullscreen = false;
  Forces forces = Forces::kBoth;
  bool sound = false;
  std::string screenshot_file;
  std::string film_file;
  std::string log_file;
  std::string summary_file;
  OutputSettings outputs;   ///< recording of the run, and watchers
  std::string replay_file;  ///< recorded run to render again; empty: none
  StudySettings study;
  double stiffness_N_mm = 0.0;  ///< of all surfaces of a replay; 0: as recorded
  bool method_given = false, surface_given = false;  ///< the user set --method, --surface
  std::string fault_folder;                          ///< empty: the state folder
  /// Limit of an author's stiffness; 0: three times the profile's stiffness.
  double stiffness_limit_N_mm = 0.0;
  bool rearm = false;    ///< re-arm automatically after a lost device or a loss of trust
  double seconds = 0.0;  ///< duration of the run; 0: until Ctrl-C
  Method method = Method::kHapticast;
  std::string config_file;  ///< file of --config; empty: none
  bool quiet = false;
};

/// Checks before a run that --hand applies to the device. Throws std::runtime_error with one line
/// if the command line requests another device than the virtual one.
void requireVirtualHand(const Settings& settings);
/// Checks before a run that each output has a file of its own. Throws std::runtime_error with one
/// line, which names both flags and the file.
void requireDistinctOutputs(const Settings& settings);

}  // namespace hapticast::client
