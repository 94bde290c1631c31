// SPDX-License-Identifier: MIT
// hapticast-client's settings and their defaults. command_line.hpp reads them.
#pragma once

#include <cstdint>
#include <string>

#include "client/device/falcon_settings.hpp"
#include "client/haptics/contact/surface_model.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "common/endpoint.hpp"

namespace hapticast::client {

/// Whether there is a window (--view). kAuto: where there is a display, and nothing was asked for
/// that runs by itself.
enum class ViewChoice : std::uint8_t { kAuto, kOn, kOff };
/// Which forces are felt (--forces).
enum class Forces : std::uint8_t { kBoth, kStatic, kDynamic };

struct Settings {
  Endpoint server{"localhost", kDefaultPort};
  std::string announced;      ///< of the server that is wanted (mdns:NAME); empty: `server`
  bool server_given = false;  ///< one of both
  bool list_servers = false;
  std::string device = "auto";
  std::string profile;  ///< a built-in name or a file; empty: as the device has it
  FalconSettings falcon;
  bool list_devices = false;
  double calibration_g = 0.0;  ///< the known weight; 0: no calibration
  DeliverySettings delivery;
  SurfaceKind surface = SurfaceKind::kProxy;
  std::string hand = "press";  ///< a script's name or a CSV file
  bool hand_given = false;     ///< somebody has asked for a scripted hand
  ViewChoice view = ViewChoice::kAuto;
  Forces forces = Forces::kBoth;
  bool sound = false;
  std::string screenshot_file;
  std::string film_file;
  std::string log_file;
  std::string summary_file;
  std::string fault_folder;           ///< empty: the state folder
  double stiffness_limit_N_mm = 0.0;  ///< 0: three times the profile's stiffness
  bool rearm = false;                 ///< after a lost device or trust the force returns by itself
  double seconds = 0.0;               ///< 0: until Ctrl-C
  Method method = Method::kHapticast;
  std::string config_file;  ///< that --config named; empty: none
  bool quiet = false;
};

/// Finds out before a session whether `file` (empty: nothing was asked for) can be written after
/// it. Throws std::runtime_error, one line that names `flag` and `file`.
void requireWritable(const char* flag, const std::string& file);

}  // namespace hapticast::client
