// SPDX-License-Identifier: MIT
// Converts a C++ class to a driver: makeDriver() fills the table of functions of
// hapticast_device.h. An exception of the class becomes the text `why` of the C interface. The
// class has this form:
//   class Device {
//     static void list(const hapticast_host& host, const FoundDevice& found);  // may throw
//     Device(const hapticast_host& host, const char* id, hapticast_profile& profile);  // may throw
//     void wait(LocalTime deadline);  // may be absent: the host's timer then paces the loop
//     void exchange(const Vec3& force_N, hapticast_state& state);
//     bool commandZero();  // returns true if the device received it
//   };
// The constructor opens the device and fills the profile. The destructor commands zero. An error of
// list() or of the constructor is a std::runtime_error.
// Thread: each function runs in the thread that hapticast_device.h states.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "client/device/hapticast_device.h"
#include "client/device/profile/device_profile.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Receives a detected device: its serial number `id`, and in `problem` the reason why it cannot be
/// opened, with the remedy. An empty `problem` means that it can be opened.
using FoundDevice = std::function<void(const std::string& id, const std::string& problem)>;

inline constexpr std::size_t kReason_bytes = 256;  ///< size of `why` in hapticast_device.h

/// Copies `text`, with a final zero, into the buffer `to` of `size` bytes. Truncates a longer text.
inline void copyText(std::string_view text, char* to, std::size_t size) {
  to[text.copy(to, size - 1)] = '\0';
}

/// Copies the properties of a built-in profile into that of the opened device.
inline void copyProfile(const PlantProfile& from, hapticast_profile& to) {
  to.delay_ticks = from.delay_ticks;
  to.mass_kg = from.mass_kg;
  to.peak_N = from.peak_N;
  to.continuous_N = from.continuous_N;
  to.count_mm = from.count_mm;
  to.stiffness_N_mm = from.stiffness_N_mm;
  std::copy_n(from.workspace_mm.data(), 3, to.workspace_mm);
}

/// The functions of the table for one class.
template <class Device>
struct DriverFunctions {
  static Device& cast(hapticast_device* device) { return *reinterpret_cast<Device*>(device); }

  static int list(const hapticast_host* host, void (*found)(void*, const char*, const char*),
                  void* to, char* why) {
    try {
      Device::list(*host, [&](const std::string& id, const std::string& problem) {
        found(to, id.c_str(), problem.empty() ? nullptr : problem.c_str());
      });
      return HAPTICAST_OK;
    } catch (const std::runtime_error& error) {
      copyText(error.what(), why, kReason_bytes);
      return HAPTICAST_LOST;
    }
  }
  static hapticast_device* open(const hapticast_host* host, const char* id,
                                hapticast_profile* profile, char* why) {
    try {
      return reinterpret_cast<hapticast_device*>(new Device(*host, id, *profile));
    } catch (const std::runtime_error& error) {
      copyText(error.what(), why, kReason_bytes);
      return nullptr;
    }
  }
  static int wait(hapticast_device* device, std::int64_t until_ns) {
    cast(device).wait(LocalTime(Duration(until_ns)));
    return HAPTICAST_OK;
  }
  static int exchange(hapticast_device* device, const double force_N[3], hapticast_state* state) {
    cast(device).exchange({force_N[0], force_N[1], force_N[2]}, *state);
    return HAPTICAST_OK;
  }
  static int zero(hapticast_device* device) { return cast(device).commandZero() ? 0 : 1; }
  static void close(hapticast_device* device) { delete &cast(device); }
  static void warn(hapticast_device* device, int on) { cast(device).warn(on != 0); }
};

/// Returns the driver table for the class `Device`. `name`, `about` and `flags` are as in
/// hapticast_driver. The texts must outlive the table.
template <class Device>
hapticast_driver makeDriver(const char* name, const char* about, std::uint32_t flags = 0) {
  using Functions = DriverFunctions<Device>;
  hapticast_driver driver{sizeof(hapticast_driver),
                          HAPTICAST_DEVICE_ABI,
                          name,
                          about,
                          "MIT",
                          flags,
                          0,
                          Functions::list,
                          Functions::open,
                          nullptr,
                          Functions::exchange,
                          Functions::zero,
                          Functions::close,
                          nullptr};
  if constexpr (requires(Device & device) { device.wait(LocalTime()); })
    driver.wait = Functions::wait;
  if constexpr (requires(Device & device) { device.warn(true); }) driver.warn = Functions::warn;
  return driver;
}

}  // namespace hapticast::client
