// SPDX-License-Identifier: MIT
#include "client/device/dhd/dhd_sdk.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "client/device/helper/program/library.hpp"

namespace hapticast::client {

DhdSdk::DhdSdk(const hapticast_host& host) {
  const Library library(host, "Force Dimension's SDK",
                        {"libdhd.so", "libdhd.so.3", "libdhd.so.3.17.6", "libdhd.so.3.17.0",
                         "libdhd.so.3.16.0", "libdhd.so.3.14.0"});
  library.require(getDeviceCount, "dhdGetDeviceCount");
  library.require(open, "dhdOpen");
  library.require(close, "dhdClose");
  library.require(enableForce, "dhdEnableForce");
  library.require(getPosition, "dhdGetPosition");
  library.require(setForce, "dhdSetForce");
  library.require(errorGetLastStr, "dhdErrorGetLastStr");
  library.find(openId, "dhdOpenID");
  library.find(getSerialNumber, "dhdGetSerialNumber");
  library.find(getSystemName, "dhdGetSystemName");
  library.find(getButtonMask, "dhdGetButtonMask");
  library.find(getButton, "dhdGetButton");
}

char DhdSdk::openDevice(const char* serial) const {
  if (serial == nullptr || *serial == '\0') {
    const int number = open();
    if (number < 0)
      throw std::runtime_error("no device opens: " + readError() +
                               "; is it plugged in, switched on and free?");
    return static_cast<char>(number);
  }
  if (openId == nullptr || getSerialNumber == nullptr)
    throw std::runtime_error("this library cannot select a device by its serial number");
  const int count = getDeviceCount();
  for (int i = 0; i < count; ++i) {
    const int number = openId(static_cast<char>(i));
    if (number < 0) continue;
    if (readSerial(static_cast<char>(number)) == serial) return static_cast<char>(number);
    (void)close(static_cast<char>(number));
  }
  throw std::runtime_error("no free device has the serial number " + std::string(serial) +
                           "; see hapticast-client list --devices");
}

std::string DhdSdk::readSerial(char number) const {
  unsigned short serial = 0;
  const bool known = getSerialNumber != nullptr && getSerialNumber(&serial, number) >= 0;
  return known ? std::to_string(serial) : "";
}

std::string DhdSdk::readName(char number) const {
  const char* const text = getSystemName == nullptr ? nullptr : getSystemName(number);
  std::string name = text == nullptr ? "" : text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return name;
}

unsigned DhdSdk::readButtons(char number) const {
  if (getButtonMask != nullptr) return getButtonMask(number);
  return getButton != nullptr && getButton(0, number) > 0 ? 1 : 0;
}

std::string DhdSdk::readError() const {
  const char* const text = errorGetLastStr();
  return text == nullptr ? "unknown reason" : text;
}

}  // namespace hapticast::client
