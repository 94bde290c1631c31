// SPDX-License-Identifier: MIT
// The subcommands that compute a clip without viewers: preview and bake.
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "common/cli/options.hpp"
#include "common/cli/subcommands.hpp"
#include "common/text.hpp"
#include "server/author/author_options.hpp"
#include "server/settings/clip_options.hpp"
#include "server/settings/subcommand_options.hpp"
#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

void addClip(CLI::App& app, std::string& source) {
  app.add_option("SOURCE,--source", source,
                 "The clip: synthetic:NAME, a folder, COLOR,DEPTH or FILE (hapticast-server serve "
                 "--help)")
      ->required();
}

/// Adds -o of a preview. Its value is a file for one picture, or a folder for several.
void addPictures(CLI::App& app, std::string& preview) {
  const auto set = [&preview](const std::string& text) {
    std::error_code error;
    const std::filesystem::path place(text);
    const bool picture = hasEnding(text, ".png");
    const bool folder = std::filesystem::is_directory(place, error) || !place.has_extension();
    if (text.empty() || !(picture || folder)) {
      throw CLI::ValidationError("--preview", quote(text) + " is not FILE.png or a folder");
    }
    preview = text;
  };
  app.add_option_function<std::string>(
         "-o,--preview", set,
         "The picture, or a folder, which also has the outlines of the whole clip")
      ->type_name("FILE.png|FOLDER")
      ->required();
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

/// Returns the flags that change the frames of a bake, as one text.
std::string listBakeFlags(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* const option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (name == "source" || name == "out" || name == "resume") continue;
    for (const std::string& value : option->results())
      text.append(" --").append(name).append(" ").append(value);
  }
  return text;
}

/// Adds -o of a bake: a recording, or a folder with one.
void addRecording(CLI::App& app, BakeChoices& bake) {
  const auto set = [&bake](const std::string& text) {
    bake.out = text;
    if (!text.ends_with('/') && !hasEnding(text, ".mcap"))
      throw CLI::ValidationError("-o", quote(text) + " is neither FILE.mcap nor FOLDER/");
  };
  app.add_option_function<std::string>("-o,--out", set,
                                       "The new recording, or the folder for it and its page")
      ->type_name("FILE.mcap|FOLDER/")
      ->required();
}

}  // namespace

void addFrames(CLI::App& app, std::uint64_t& frames) {
  addNumber(app, "--frames", frames, std::uint64_t{1}, std::uint64_t{1'000'000'000}, "N",
            "Stop after N frames");
}

void addPreviewCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(program, "preview",
                                "Write the server's result for a clip (outline, relief, advice) "
                                "to a picture, or with the outlines of all frames into a folder");
  addClip(app, settings.source);
  addPictures(app, settings.preview);
  addFrames(app, settings.frames);
  addName(app, settings.name);
  addClipOptions(app, settings);
  app.final_callback([&settings, &app] {
    settings.command = Command::kPreview;
    finishClip(app, settings);
  });
}

void addBakeCommand(CLI::App& program, Settings& settings) {
  CLI::App& app = addSubcommand(
      program, "bake",
      "Compute a clip as well as possible, without a limit of time, and write a recording, which "
      "`serve FILE.mcap` plays. A folder also has a page, which plays the recording from any web "
      "server. Ctrl-C ends the work; --resume continues it");
  BakeChoices& bake = settings.bake;
  addClip(app, settings.source);
  addRecording(app, bake);
  app.add_option("--picture-quality", bake.picture_quality,
                 "Quality of the pictures (JPEG); a page on the web loads sooner with less. "
                 "Default: 80")
      ->check(CLI::Range(1, 100));
  app.add_flag("--resume", bake.resume,
               "Continue an interrupted bake of the same clip with the same flags, from "
               "FILE.mcap.part");
  addFrames(app, settings.frames);
  addName(app, settings.name);
  addClipOptions(app, settings);
  app.final_callback([&settings, &app] {
    settings.command = Command::kBake;
    requireClip(settings);
    finishClip(app, settings);
    if (settings.vision.low_latency)
      throw CLI::ValidationError("--low-latency",
                                 "a bake has no limit of time; leave the flag out");
    settings.bake.flags = listBakeFlags(app);
  });
}

}  // namespace hapticast::server
