// SPDX-License-Identifier: MIT
#include "server/show/producers.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/cli/run_program.hpp"
#include "server/page/page_folder.hpp"
#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/open_clip.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/show/bake/bake_progress.hpp"
#include "server/show/bake/baked_file.hpp"
#include "server/show/show.hpp"
#include "server/vision/describe.hpp"
#include "server/vision/offline/offline_vision.hpp"

namespace hapticast::server {

namespace {

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

std::unique_ptr<RgbdSource> openRecorded(const Settings& settings) {
  auto source = openClip(settings);
  if (source->info().live)
    throw SourceError(settings.source + ": a live source has no later frames; record it instead");
  return source;
}

/// Adds the page to the recording in `folder`.
void completePage(const std::string& folder) {
  writePageFolder(folder);
  spdlog::info("{} is complete: any web server can serve it, such as python3 -m http.server -d {}",
               folder, folder);
}

/// The clip of a bake and its file.
struct BakedClip {
  explicit BakedClip(const Settings& settings)
      : source(openRecorded(settings)),
        vision_settings(preparePoints(settings.vision, source->info())),
        vision(*source, describeSource(*source, settings), vision_settings),
        slices{.error_mm = computeHeightError_mm(vision_settings)},
        file(findRecording(settings.bake), makeFingerprint(settings, source->info()),
             static_cast<std::uint64_t>(std::max(1L, std::lround(source->info().fps))),
             settings.bake.resume) {}

  std::unique_ptr<RgbdSource> source;
  VisionSettings vision_settings;
  OfflineVision vision;
  SliceSettings slices;
  BakedFile file;  // after all that refuses wrong input
};

/// Computes a clip with OfflineVision and writes a recording (BakedFile). It has no port and no
/// pace, and drops no frame. It opens the clip in prepare(), so that a signal meanwhile interrupts
/// the bake and not the program.
class BakeProducer final : public Producer {
 public:
  BakeProducer(const Settings& settings, const Clock& clock)
      : settings_(settings), progress_(clock, settings.quiet) {}

  void prepare() override;
  void start() override;
  bool step() override;
  bool finish() override;
  void release() noexcept override {
    progress_.clear();  // before the line of an error
    clip_.reset();
  }

 private:
  [[nodiscard]] std::uint64_t frames() const { return clip_ ? clip_->file.frames() : 0; }
  void addFrame(const VisionResult& result);

  const Settings& settings_;
  BakeProgress progress_;
  std::optional<BakedClip> clip_;
  std::uint64_t kept_ = 0;  // frames of the bake before
  std::uint64_t done_ = 0;
  std::uint64_t limit_ = UINT64_MAX;
  bool is_complete_ = false;
};

void BakeProducer::prepare() {
  clip_.emplace(settings_);
  const bool can_touch = warnOfUnlikelyInput(*clip_->source, clip_->vision_settings);
  if (frames() > 0) spdlog::info("continues after {} frames", frames());
  progress_.begin("scans the clip");
  const bool whole = clip_->vision.scan([this](std::uint64_t done, std::uint64_t total) {
    progress_.show(done, total);
    return !show_->stopped();
  });
  progress_.clear();
  if (!whole || show_->stopped()) return;
  DepthRangeLog().log(clip_->vision.vision().mapped());
  if (can_touch) warnOfNoObject(clip_->vision.vision(), clip_->source->info().name);
}

void BakeProducer::start() {
  progress_.begin("bakes");
  if (settings_.frames != 0) limit_ = settings_.frames;
  kept_ = frames();
}

bool BakeProducer::step() {
  const bool wanted = done_ >= kept_;
  if (wanted && done_ < limit_ && clip_->file.beginsBlock()) clip_->vision.beginBlock();
  auto result = done_ < limit_ ? clip_->vision.next(wanted) : std::nullopt;
  is_complete_ = !result;
  if (is_complete_) return false;
  if (wanted) addFrame(*result);
  progress_.show(++done_, std::min(limit_, clip_->source->info().frame_count.value_or(0)));
  return true;
}

bool BakeProducer::finish() {
  progress_.clear();
  if (!is_complete_) {
    if (frames() > 0)
      spdlog::warn("interrupted: the same command with --resume continues {}.part",
                   findRecording(settings_.bake));
    else
      spdlog::warn("interrupted before the first frame");
    return false;
  }
  clip_->file.finish();
  const std::string& out = settings_.bake.out;
  if (out.ends_with('/'))
    completePage(out);
  else
    spdlog::info("{} is complete; --source {} plays it", out, out);
  return true;
}

void BakeProducer::addFrame(const VisionResult& result) {
  clip_->file.add(clip_->vision.vision().description(), result.frame, clip_->slices,
                  encodePicture(result.color, settings_.bake.picture_quality));
}

}  // namespace

std::unique_ptr<Producer> makeBakeProducer(const Settings& settings, const Clock& clock) {
  const std::string& out = settings.bake.out;
  if (out.ends_with('/')) createPageFolder(out);
  return std::make_unique<BakeProducer>(settings, clock);
}

}  // namespace hapticast::server
