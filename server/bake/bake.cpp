// SPDX-License-Identifier: MIT
#include "server/bake/bake.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/cli/run_program.hpp"
#include "server/bake/bake_progress.hpp"
#include "server/bake/baked_file.hpp"
#include "server/page/page_folder.hpp"
#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/open_clip.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/vision/describe.hpp"
#include "server/vision/offline/offline_vision.hpp"

namespace hapticast::server {

namespace {

volatile std::sig_atomic_t stop_signal = 0;

/// Notes Ctrl-C; a second one ends the program at once.
void onStopSignal(int signal) {
  stop_signal = signal;
  std::signal(signal, SIG_DFL);
}

/// Adds size and newest time of a file, or of all files in a folder.
struct FileSums {
  std::uintmax_t files = 0, bytes = 0;
  std::filesystem::file_time_type::rep newest = 0;

  void add(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) {
      ++files;
      bytes += std::filesystem::file_size(path, error);
      const auto time = std::filesystem::last_write_time(path, error);
      if (!error) newest = std::max(newest, time.time_since_epoch().count());
    }
    for (auto each = std::filesystem::recursive_directory_iterator(path, error);
         !error && each != std::filesystem::recursive_directory_iterator(); each.increment(error)) {
      if (each->is_regular_file(error)) add(each->path());
    }
  }
};

/// Returns what the frames depend on, as a text.
std::string makeFingerprint(const Settings& settings, const SourceInfo& info) {
  FileSums sums;
  const std::string& source = settings.source;
  for (std::size_t begin = 0; begin <= source.size();) {
    const std::size_t end = std::min(source.find(',', begin), source.size());
    sums.add(source.substr(begin, end - begin));
    begin = end + 1;
  }
  if (!settings.vision.scene_file.empty()) sums.add(settings.vision.scene_file);
  for (const KeyMaskFile& mask : settings.key_masks) sums.add(mask.file);
  return fmt::format(
      "hapticast-server {} baked {}{} ({} x {}, {:g} frames/s; {} files, {} bytes, changed {})",
      programVersion(), source, settings.bake.flags, info.width_px, info.height_px, info.fps,
      sums.files, sums.bytes, sums.newest);
}

/// Returns the file of the recording.
std::string findRecording(const BakeChoices& bake) {
  return bake.out + (bake.out.ends_with('/') ? kPageRecording : "");
}

/// One bake.
class Bake {
 public:
  Bake(const Settings& settings, const Clock& clock);
  /// Scans the clip. Returns false after a signal.
  bool scan();
  /// Writes the frames. Returns whether the file is complete; false after a signal.
  bool write();
  [[nodiscard]] std::uint64_t frames() const { return file_.frames(); }

 private:
  [[nodiscard]] SourceInfo describe() const;
  void addFrame(const VisionResult& result);

  const Settings& settings_;
  BakeProgress progress_;
  std::unique_ptr<RgbdSource> source_;
  VisionSettings vision_settings_;
  OfflineVision vision_;
  SliceSettings slices_;
  BakedFile file_;  // after all that refuses wrong input
};

std::unique_ptr<RgbdSource> openRecorded(const Settings& settings) {
  auto source = openClip(settings);
  if (source->info().live)
    throw SourceError(settings.source + ": a live source has no later frames; record it instead");
  return source;
}

Bake::Bake(const Settings& settings, const Clock& clock)
    : settings_(settings),
      progress_(clock, settings.quiet),
      source_(openRecorded(settings)),
      vision_settings_(preparePoints(settings.vision, source_->info())),
      vision_(*source_, describe(), vision_settings_),
      slices_{.error_mm = computeHeightError_mm(vision_settings_)},
      file_(findRecording(settings.bake), makeFingerprint(settings, source_->info()),
            static_cast<std::uint64_t>(std::max(1L, std::lround(source_->info().fps))),
            settings.bake.resume) {}

SourceInfo Bake::describe() const {
  SourceInfo info = source_->info();
  if (!settings_.name.empty()) info.name = settings_.name;
  return info;
}

bool Bake::scan() {
  const bool can_touch = warnOfUnlikelyInput(*source_, vision_settings_);
  if (frames() > 0) spdlog::info("continues after {} frames", frames());
  progress_.begin("scans the clip");
  const bool whole = vision_.scan([this](std::uint64_t done, std::uint64_t total) {
    progress_.show(done, total);
    return stop_signal == 0;
  });
  progress_.clear();
  if (!whole || stop_signal != 0) return false;
  DepthRangeLog().log(vision_.vision().mapped());
  if (can_touch) warnOfNoObject(vision_.vision(), source_->info().name);
  return true;
}

bool Bake::write() {
  progress_.begin("bakes");
  const std::uint64_t limit = settings_.frames != 0 ? settings_.frames : UINT64_MAX;
  const std::uint64_t total = std::min(limit, source_->info().frame_count.value_or(0));
  const std::uint64_t kept = frames();
  for (std::uint64_t done = 0; done < limit; ++done) {
    if (stop_signal != 0) return false;
    const bool wanted = done >= kept;
    if (wanted && file_.beginsBlock()) vision_.beginBlock();
    auto result = vision_.next(wanted);
    if (!result) break;
    if (wanted) addFrame(*result);
    progress_.show(done + 1, total);
  }
  progress_.clear();
  file_.finish();
  return true;
}

void Bake::addFrame(const VisionResult& result) {
  file_.add(vision_.vision().description(), result.frame, slices_,
            encodePicture(result.color, settings_.bake.picture_quality));
}

/// Adds the page to the recording in `folder`.
int completePage(const std::string& folder) {
  writePageFolder(folder);
  spdlog::info("{} is complete: any web server can serve it, such as python3 -m http.server -d {}",
               folder, folder);
  return kDone;
}

}  // namespace

int bake(const Settings& settings, const Clock& clock, bool& started) {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, onStopSignal);
  const std::string& out = settings.bake.out;
  if (out.ends_with('/')) createPageFolder(out);
  Bake work(settings, clock);
  started = work.scan();
  if (started && work.write()) {
    if (out.ends_with('/')) return completePage(out);
    spdlog::info("{} is complete; --source {} plays it", out, out);
    return kDone;
  }
  if (work.frames() > 0)
    spdlog::warn("interrupted: the same command with --resume continues {}.part",
                 findRecording(settings.bake));
  else
    spdlog::warn("interrupted before the first frame");
  return kFailed;
}

}  // namespace hapticast::server
