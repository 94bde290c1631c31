// SPDX-License-Identifier: MIT
// The functions of OpenHaptics' library libHD that the driver calls. Prototypes and numbers are
// those of the public programmer's guide. Units are mm and N. The axes are x to the right, y up, z
// towards the user.
// Threads: the library's (calls within a frame), main (all others).
#pragma once

#include <string>

#include "client/device/hapticast_device.h"

namespace hapticast::client {

struct HdError {
  unsigned code;
  int internal_code;
  unsigned device;
};

struct HdFunctions {
  static constexpr unsigned kInvalidHandle = 0xFFFFFFFF;
  static constexpr unsigned kContinue = 1;  // result of a callback that is called again
  static constexpr unsigned short kHighestPriority = 65535;
  // Values:
  static constexpr unsigned kButtons = 0x2000, kPosition = 0x2050, kSerialNumber = 0x2504,
                            kCalibrationStyle = 0x2555, kForce = 0x2700, kForceOutput = 0x4000;
  // Errors:
  static constexpr unsigned kWarmMotors = 0x0200, kExceededForce = 0x0201, kFault = 0x0300,
                            kCommunication = 0x0302, kCommunicationSetUp = 0x0303;
  // Calibration:
  static constexpr unsigned kCalibrated = 0x5000, kNeedsUpdate = 0x5001;
  static constexpr int kStyles[] = {2, 4, 1};  // automatic, inkwell, encoder reset

  /// Leaves all functions null.
  HdFunctions() = default;
  /// Loads the library. Throws std::runtime_error (one line).
  explicit HdFunctions(const hapticast_host& host);

  /// Opens the device `name` (null: the default one), makes it the current one, and returns its
  /// handle. Throws std::runtime_error (one line).
  [[nodiscard]] unsigned openDevice(const char* name) const;
  /// Returns the serial number of the current device, or "".
  [[nodiscard]] std::string readSerial() const;

  unsigned (*initDevice)(const char* name) = nullptr;
  void (*disableDevice)(unsigned device) = nullptr;
  void (*makeCurrentDevice)(unsigned device) = nullptr;
  void (*beginFrame)(unsigned device) = nullptr;
  void (*endFrame)(unsigned device) = nullptr;
  void (*enable)(unsigned capability) = nullptr;
  void (*disable)(unsigned capability) = nullptr;
  HdError (*getError)() = nullptr;
  const char* (*getErrorString)(unsigned code) = nullptr;
  void (*getDoubles)(unsigned value, double* to) = nullptr;
  void (*getIntegers)(unsigned value, int* to) = nullptr;
  const char* (*getString)(unsigned value) = nullptr;
  void (*setDoubles)(unsigned value, const double* from) = nullptr;
  unsigned (*checkCalibration)() = nullptr;
  void (*updateCalibration)(unsigned style) = nullptr;
  unsigned long (*scheduleAsynchronous)(unsigned (*callback)(void*), void* data,
                                        unsigned short priority) = nullptr;
  void (*unschedule)(unsigned long callback) = nullptr;
  void (*startScheduler)() = nullptr;
  void (*stopScheduler)() = nullptr;
};

}  // namespace hapticast::client
