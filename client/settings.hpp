// SPDX-License-Identifier: MIT
// Settings of hapticast-client and their defaults. command_line.hpp fills them.
// Thread: main; constant after start-up.
#pragma once

#include <cstdint>
#include <string>

#include "client/device/open_device.hpp"
#include "client/haptics/contact/surface_model.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "common/endpoint.hpp"

namespace hapticast::client {

/// --view. kAuto opens a window if there is a display and no flag requests an unattended run.
enum class ViewChoice : std::uint8_t { kAuto, kOn, kOff };
/// --forces: the forces that are rendered.
enum class Forces : std::uint8_t { kBoth, kStatic, kDynamic };

struct Settings {
  Endpoint server{"localhost", kDefaultPort};
  std::string announced;      ///< mDNS name of the requested server (mdns:NAME); empty: `server`
  bool server_given = false;  ///< `server` or `announced` was given
  bool list_servers = false;
  std::string device = "auto";
  std::string profile;  ///< a built-in name or a file; empty: default of the device
  FalconSettings falcon;
  bool list_devices = false;
  double calibration_g = 0.0;  ///< weight in g; 0: no calibration
  DeliverySettings delivery;
  SurfaceKind surface = SurfaceKind::kProxy;
  std::string hand = "press";  ///< name of a script, or a CSV file
  bool hand_given = false;     ///< --hand was given
  ViewChoice view = ViewChoice::kAuto;
  Forces forces = Forces::kBoth;
  bool sound = false;
  std::string screenshot_file;
  std::string film_file;
  std::string log_file;
  std::string summary_file;
  std::string fault_folder;           ///< empty: the state folder
  double stiffness_limit_N_mm = 0.0;  ///< 0: three times the profile's stiffness
  bool rearm = false;    ///< automatic re-arming after a lost device or a loss of trust
  double seconds = 0.0;  ///< 0: until Ctrl-C
  Method method = Method::kHapticast;
  std::string config_file;  ///< file of --config; empty: none
  bool quiet = false;
};

/// Checks before a run that `file` (empty: not requested) can be written after it. Throws
/// std::runtime_error with one line: `flag` and `file`.
void requireWritable(const char* flag, const std::string& file);

}  // namespace hapticast::client
