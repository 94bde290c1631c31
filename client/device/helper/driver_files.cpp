// SPDX-License-Identifier: MIT
#include "client/device/helper/driver_files.hpp"

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "common/text.hpp"

namespace hapticast::client {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSystemFolder = "/usr/lib/hapticast/devices";
constexpr std::size_t kLongestDriverName = 32;

[[noreturn]] void refuse(const std::string& file, const std::string& reason) {
  throw std::runtime_error(file + ": " + reason);
}

/// A driver is code: only root and the user may be able to write it.
void requireSafe(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) refuse(path, std::strerror(errno));
  if (status.st_uid != 0 && status.st_uid != geteuid())
    refuse(path, "belongs to another user; copy it to a file of your own");
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    refuse(path, "others may write it; run chmod go-w " + path);
}

bool isText(const char* text) {
  constexpr std::size_t kLongestText = 300;
  return text != nullptr && strnlen(text, kLongestText) < kLongestText;
}

/// Throws unless all members that the host uses are there.
void requireComplete(const hapticast_driver* driver, const std::string& name,
                     const std::string& file) {
  if (driver == nullptr) refuse(file, "hapticast_device_v1() returns no driver");
  if (driver->abi != HAPTICAST_DEVICE_ABI)
    refuse(file, "has version " + std::to_string(driver->abi) + " of the interface, not " +
                     std::to_string(HAPTICAST_DEVICE_ABI) +
                     "; build it with this version's hapticast_device.h");
  constexpr std::size_t kLeast_bytes = offsetof(hapticast_driver, warn);
  if (driver->size < kLeast_bytes)
    refuse(file, "its driver structure has " + std::to_string(driver->size) + " bytes, not " +
                     std::to_string(kLeast_bytes) + " or more");
  if (!isText(driver->name) || driver->name != name)
    refuse(file, "the driver in it has another name than its file");
  if (!isText(driver->about) || !isText(driver->licence))
    refuse(file, "its driver structure has no `about` or no `licence`");
  if (driver->list == nullptr || driver->open == nullptr || driver->exchange == nullptr ||
      driver->zero == nullptr || driver->close == nullptr)
    refuse(file, "its driver structure lacks a function (only `wait` may be null)");
}

}  // namespace

std::vector<std::string> driverFolders() {
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  std::string data = variable("XDG_DATA_HOME");
  if (const std::string home = variable("HOME"); data.empty() && !home.empty())
    data = home + "/.local/share";
  std::vector<std::string> folders;
  if (fs::path(data).is_absolute()) folders.push_back(data + "/hapticast/devices");
  folders.emplace_back(kSystemFolder);
  return folders;
}

bool isDriverName(const std::string& name) noexcept {
  return !name.empty() && name.size() <= kLongestDriverName &&
         std::all_of(name.begin(), name.end(), [](char each) {
           return (each >= 'a' && each <= 'z') || (each >= '0' && each <= '9') || each == '_';
         });
}

std::vector<std::string> listDriverFiles(const std::vector<std::string>& folders) {
  std::set<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().stem().string();
      if (entry.path().extension() == ".so" && isDriverName(name)) names.insert(name);
    }
  }
  return {names.begin(), names.end()};
}

const hapticast_driver* loadDriverFile(const std::string& name,
                                       const std::vector<std::string>& folders) {
  if (!isDriverName(name)) return nullptr;
  for (const std::string& folder : folders) {
    const std::string file = fs::path(folder) / (name + ".so");
    std::error_code error;
    if (!fs::exists(file, error)) continue;
    requireSafe(folder);
    requireSafe(file);
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) refuse(file, std::string("cannot be loaded: ") + dlerror());
    void* const symbol = dlsym(library, "hapticast_device_v1");
    if (symbol == nullptr) refuse(file, "exports no hapticast_device_v1(); is it a driver?");
    const auto* const driver = reinterpret_cast<decltype(&hapticast_device_v1)>(symbol)();
    requireComplete(driver, name, file);
    return driver;
  }
  return nullptr;
}

}  // namespace hapticast::client
