// SPDX-License-Identifier: MIT
#include "client/device/device_request.hpp"

namespace hapticast::client {

std::map<std::string, std::string> selectDriverOptions(
    const std::map<std::string, std::string>& options, const std::string& driver) {
  std::map<std::string, std::string> selected;
  const std::string own = driver + ".";
  for (const auto& [key, value] : options) {
    if (key.find('.') == std::string::npos) selected.emplace(key, value);
    if (key.starts_with(own)) selected[key.substr(own.size())] = value;
  }
  return selected;
}

PlantProfile loadProfile(const std::string& name_or_file, const std::string& own) {
  try {
    return loadDeviceProfile(name_or_file.empty() ? own : name_or_file);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("--profile ") + error.what());
  }
}

}  // namespace hapticast::client
