// SPDX-License-Identifier: MIT
#include "server/settings/child_options.hpp"

#include <string>

#include "common/cli/options.hpp"

namespace hapticast::server {

namespace {

void addCommand(CLI::App& app, const char* flag, std::string& command, const char* help) {
  const auto set = [&command, flag](const std::string& text) {
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
      throw CLI::ValidationError(flag, "is empty; give a command of the shell");
    command = text;
  };
  app.add_option_function<std::string>(flag, set, help)->type_name("COMMAND");
}

}  // namespace

void addChildOptions(CLI::App& app, ChildSettings& settings) {
  addCommand(app, "--depth-from", settings.depth_command,
             "Your own program that estimates depth, so the source needs colour alone. It receives "
             "each picture on stdin (PPM) and answers on stdout: a line `WIDTH HEIGHT metric_mm`, "
             "`relative` or `inverse`, then float32 (server/source/README.md)");
  app.add_option("--depth-cache", settings.depth_cache,
                 "Keep the depths of --depth-from in this folder, by clip and command")
      ->type_name("FOLDER");
  addNumber(app, "--depth-cache-limit", settings.depth_cache_GB, 0.001, 1e5, "GB",
            "The size at which the clips used least recently leave the cache; default: 10");
  addCommand(app, "--mask-from", settings.mask_command,
             "Your own program that segments. It receives each picture, its depth and your points "
             "on stdin and answers on stdout: a line `WIDTH HEIGHT`, then a byte for each pixel, "
             "or `0 0` for no mask");
}

void requireChildFlags(const CLI::App& app, const Settings& settings) {
  const ChildSettings& child = settings.child;
  if (child.depth_command.empty()) {
    if (!child.depth_cache.empty())
      throw CLI::ValidationError("--depth-cache", "needs --depth-from");
  } else {
    for (const char* const flag :
         {"--layout", "--depth-code", "--depth-near", "--depth-unit", "--depth", "--topics"}) {
      if (app.count(flag) > 0)
        throw CLI::ValidationError(flag,
                                   "the depth comes from --depth-from; leave one of both out");
    }
  }
  const bool other = settings.vision.segment != SegmentMode::kAuto &&
                     settings.vision.segment != SegmentMode::kBand;
  if (!child.mask_command.empty() && other)
    throw CLI::ValidationError("--mask-from", "needs --segment auto or band");
}

}  // namespace hapticast::server
