// SPDX-License-Identifier: MIT
#include "client/device/touch/hd_functions.hpp"

#include <stdexcept>

#include "client/device/helper/program/library.hpp"

namespace hapticast::client {

HdFunctions::HdFunctions(const hapticast_host& host) {
  const Library library(
      host, "OpenHaptics",
      {"libHD.so", "libHD.so.3.4", "libHD.so.3.4.0", "libHD.so.3", "libHD.so.3.0"});
  library.require(initDevice, "hdInitDevice");
  library.require(disableDevice, "hdDisableDevice");
  library.require(makeCurrentDevice, "hdMakeCurrentDevice");
  library.require(beginFrame, "hdBeginFrame");
  library.require(endFrame, "hdEndFrame");
  library.require(enable, "hdEnable");
  library.require(disable, "hdDisable");
  library.require(getError, "hdGetError");
  library.require(getErrorString, "hdGetErrorString");
  library.require(getDoubles, "hdGetDoublev");
  library.require(getIntegers, "hdGetIntegerv");
  library.require(getString, "hdGetString");
  library.require(setDoubles, "hdSetDoublev");
  library.require(checkCalibration, "hdCheckCalibration");
  library.require(updateCalibration, "hdUpdateCalibration");
  library.require(scheduleAsynchronous, "hdScheduleAsynchronous");
  library.require(unschedule, "hdUnschedule");
  library.require(startScheduler, "hdStartScheduler");
  library.require(stopScheduler, "hdStopScheduler");
}

unsigned HdFunctions::openDevice(const char* name) const {
  const unsigned device = initDevice(name);
  const HdError error = getError();
  if (error.code == 0 && device != kInvalidHandle) {
    makeCurrentDevice(device);
    return device;
  }
  const char* const text = getErrorString(error.code);
  if (device != kInvalidHandle) disableDevice(device);
  throw std::runtime_error("no device opens: " + std::string(text == nullptr ? "" : text) +
                           "; is it connected, switched on, free, and known to the maker's set-up "
                           "program?");
}

std::string HdFunctions::readSerial() const {
  const char* const text = getString(kSerialNumber);
  return text == nullptr ? "" : text;
}

}  // namespace hapticast::client
