// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string_view>

#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/text.hpp"
#include "server/page/page_folder.hpp"
#include "server/settings/bake_settings.hpp"
#include "server/settings/child_options.hpp"
#include "server/settings/command_line.hpp"
#include "server/settings/scene_option.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

// The flags of the server that a bake obeys, too. All others are for a stream.
// clang-format off
constexpr auto kBakeFlags = std::to_array<std::string_view>(
    {"fps",         "layout",     "depth-code",     "depth-near",     "depth-unit", "color",
     "depth",       "to-and-fro", "frames",         "name",           "segment",    "fov",
     "stretch",     "motion",     "compensate-pan", "method",         "object",     "not",
     "depth-range", "map-range",  "stiffness",      "damping",        "friction",   "texture-depth",
     "mass",        "scene",      "plan",           "error-budget",   "quiet",      "config",
     "help",        "version",    "print-config",   "picture-quality", "depth-from", "depth-cache",
     "depth-cache-limit", "mask-from", "vision-threads"});
// clang-format on

bool isBakeFlag(const CLI::Option& option) {
  return std::find(kBakeFlags.begin(), kBakeFlags.end(), option.get_single_name()) !=
         kBakeFlags.end();
}

/// Throws CLI::ValidationError for a source that is no clip.
void requireClip(const Settings& settings) {
  constexpr std::array kLive{"camera:", "openni:", "v4l2:"};
  const std::string& source = settings.source;
  const bool live =
      isAddress(source) || std::any_of(kLive.begin(), kLive.end(),
                                       [&](const char* kind) { return source.starts_with(kind); });
  if (live)
    throw CLI::ValidationError(
        "bake " + hideCredentials(source),
        "a live source has no later frames; record it with --record, or save its images");
  if (isRecording(settings))
    throw CLI::ValidationError("bake " + source,
                               "a recording has its frames already; name the clip instead");
}

std::string listBakeFlags(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* const option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (!isBakeFlag(*option) || name == "quiet") continue;
    for (const std::string& value : option->results())
      text.append(" --").append(name).append(" ").append(value);
  }
  return text;
}

/// Adds -o: a recording, or a folder with one.
void addOutput(CLI::App& app, BakeSettings& settings) {
  const auto set = [&settings](const std::string& text) {
    if (text.ends_with('/')) settings.folder = text;
    settings.out = text + (settings.folder.empty() ? "" : kPageRecording);
    if (!hasEnding(settings.out, ".mcap"))
      throw CLI::ValidationError("-o", quote(text) + " is neither FILE.mcap nor FOLDER/");
  };
  app.add_option_function<std::string>("-o,--out", set,
                                       "The new recording, or the folder for it and its page")
      ->type_name("FILE.mcap|FOLDER/")
      ->required();
}

}  // namespace

std::unique_ptr<CLI::App> bakeCommandLine(BakeSettings& settings) {
  auto app = commandLine(settings.server);
  app->description(
      "hapticast-server bake SOURCE [FLAGS] -o FILE.mcap|FOLDER/: computes a clip as well as it "
      "can, without a limit of time, and writes a recording. --source FILE.mcap plays it. A folder "
      "also has a page, which plays the recording from any web server. Ctrl-C ends the work; "
      "--resume continues it.");
  for (CLI::Option* const option : app->get_options()) {
    if (!isBakeFlag(*option)) option->required(false)->group("");
  }
  app->add_option("SOURCE", settings.server.source,
                  "The clip: synthetic:NAME, a folder, COLOR,DEPTH or FILE (hapticast-server "
                  "--help, --source)")
      ->required();
  addOutput(*app, settings);
  app->add_option("--picture-quality", settings.picture_quality,
                  "Quality of the pictures (JPEG); a page on the web loads sooner with less. "
                  "Default: 80")
      ->check(CLI::Range(1, 100));
  app->add_flag("--resume", settings.resume,
                "Continue an interrupted bake of the same clip with the same flags, from "
                "FILE.mcap.part");
  app->final_callback([&settings, parsed = app.get()] {
    for (const CLI::Option* const option : parsed->get_options()) {
      const std::string name = option->get_single_name();
      const bool own = name == "SOURCE" || name == "out" || name == "resume";
      if (option->count() > 0 && !own && !isBakeFlag(*option))
        throw CLI::ValidationError("--" + name, "a bake streams nothing; leave the flag out");
    }
    requireClip(settings.server);
    requireChildFlags(*parsed, settings.server);
    mergeScene(*parsed, settings.server);
    settings.flags = listBakeFlags(*parsed);
  });
  return app;
}

std::optional<int> readBakeCommandLine(BakeSettings& settings, int argc, const char* const* argv) {
  const auto app = bakeCommandLine(settings);
  return parseCommandLine(*app, argc - 1, argv + 1);
}

}  // namespace hapticast::server
