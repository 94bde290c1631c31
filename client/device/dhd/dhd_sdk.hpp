// SPDX-License-Identifier: MIT
// The functions of Force Dimension's library libdhd that the driver calls. The prototypes are those
// of the SDK's public documentation. A negative result is an error. `number` is the SDK's number of
// an opened device.
// Threads: loop (setForce, getPosition, the buttons), main (all others).
#pragma once

#include <string>

#include "client/device/hapticast_device.h"

namespace hapticast::client {

struct DhdSdk {
  static constexpr int kTimeGuard = 1;  ///< result of getPosition(): no new position yet
  static constexpr int kSaturated = 2;  ///< result of setForce(): the motors cannot exert it
  static constexpr unsigned char kOn = 1;
  static constexpr unsigned char kOff = 0;

  /// Loads the library. Throws std::runtime_error (one line).
  explicit DhdSdk(const hapticast_host& host);

  /// Opens the device with this serial number (null: the first device) and returns its number.
  /// Throws std::runtime_error (one line).
  [[nodiscard]] char openDevice(const char* serial) const;
  /// Returns the serial number of an opened device, or "" if the library does not have it.
  [[nodiscard]] std::string readSerial(char number) const;
  /// Returns the name of an opened device in lower case, or "" if the library does not have it.
  [[nodiscard]] std::string readName(char number) const;
  /// Returns one bit for each button that is down.
  [[nodiscard]] unsigned readButtons(char number) const;
  /// Returns the SDK's text of its last error.
  [[nodiscard]] std::string readError() const;

  int (*getDeviceCount)() = nullptr;
  int (*open)() = nullptr;
  int (*close)(char number) = nullptr;
  int (*enableForce)(unsigned char on, char number) = nullptr;
  int (*getPosition)(double* x_m, double* y_m, double* z_m, char number) = nullptr;
  int (*setForce)(double x_N, double y_N, double z_N, char number) = nullptr;
  const char* (*errorGetLastStr)() = nullptr;
  // Null if the library lacks them:
  int (*openId)(char index) = nullptr;
  int (*getSerialNumber)(unsigned short* serial, char number) = nullptr;
  const char* (*getSystemName)(char number) = nullptr;
  unsigned (*getButtonMask)(char number) = nullptr;
  int (*getButton)(int index, char number) = nullptr;
};

}  // namespace hapticast::client
