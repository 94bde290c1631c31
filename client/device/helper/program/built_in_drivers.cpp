// SPDX-License-Identifier: MIT
#include <string_view>

#include "client/device/helper/program/helper_program.hpp"

namespace hapticast::client {

// Each one is defined in the folder of its device.
const hapticast_driver* falconDriver();
const hapticast_driver* inverse3Driver();
const hapticast_driver* dhdDriver();
const hapticast_driver* touchDriver();

const hapticast_driver* findBuiltInDriver(const std::string& name) noexcept {
#if HAPTICAST_LIBUSB
  if (name == "falcon") return falconDriver();
#endif
  if (name == "inverse3") return inverse3Driver();
  if (name == "dhd") return dhdDriver();
  if (name == "touch") return touchDriver();
  return nullptr;
}

}  // namespace hapticast::client
