// SPDX-License-Identifier: MIT
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include "client/device/helper/program/helper_program.hpp"

namespace {

constexpr int kWrongUsage = 2;

int printUsage() {
  std::fputs(
      "hapticast-device: hapticast-client starts this program for each device with motors. Run "
      "hapticast-client list --devices\n",
      stderr);
  return kWrongUsage;
}

}  // namespace

int main(int argc, char** argv) {
  hapticast::client::HelperTask task;
  if (argc < 3) return printUsage();
  task.driver = argv[1];
  task.list = std::string_view(argv[2]) == "list";
  if (!task.list && std::string_view(argv[2]) != "open") return printUsage();
  for (int i = 3; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t split = argument.find('=');
    if (split == std::string::npos) return printUsage();
    task.options[argument.substr(0, split)] = argument.substr(split + 1);
  }
  return hapticast::client::runHelper(task);
}
