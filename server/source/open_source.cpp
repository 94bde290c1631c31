// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "common/text.hpp"
#include "server/source/folder/image_sequence.hpp"
#include "server/source/known_files.hpp"
#include "server/source/live/network_stream.hpp"
#include "server/source/live/openni_camera.hpp"
#include "server/source/live/v4l2_camera.hpp"
#include "server/source/picture/npy_stack.hpp"
#include "server/source/recording/recording_source.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/stream_url.hpp"
#include "server/source/synthetic/synthetic_source.hpp"
#include "server/source/video/video_clip.hpp"
#include "server/source/video/video_with_depth.hpp"
#include "server/source/video_folder.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kSynthetic = "synthetic:";
constexpr std::string_view kCamera = "camera:";
constexpr std::string_view kOpenni = "openni:";
constexpr std::string_view kV4l2 = "v4l2:";

std::unique_ptr<RgbdSource> openSynthetic(std::string_view name, double fps) {
  std::vector<std::string> names;
  for (const SceneName& scene : kSceneNames) {
    if (scene.name == name)
      return std::make_unique<SyntheticSource>(scene.kind, fps > 0.0 ? fps : 25.0);
    names.emplace_back(scene.name);
  }
  throw SourceError("synthetic:" + std::string(name) + ": no such scene; there are " +
                    join(names, ", ") + spellingHint(name, names));
}

/// Returns the node of a camera number.
std::string toNode(const std::string& spec, const std::string& number) {
  const auto parsed = parseNumberInRange<std::uint64_t>(number, 0, 1'000'000);
  if (!parsed)
    throw SourceError(spec + ": \"" + number +
                      "\" is not a camera number; use camera:N,M with colour N and depth M");
  return "/dev/video" + std::to_string(*parsed);
}

/// Opens the nodes in "COLOR,DEPTH", or "COLOR" if no depth is needed. With `are_numbers` they are
/// camera numbers.
std::unique_ptr<RgbdSource> openNodes(const std::string& spec, const std::string& nodes,
                                      bool are_numbers, double fps, const VideoLayout& layout) {
  const auto find = [&](const std::string& text) {
    return are_numbers ? toNode(spec, text) : text;
  };
  const std::size_t comma = nodes.find(',');
  const std::string color = find(nodes.substr(0, comma));
  if (layout.color_only && comma == std::string::npos && !nodes.empty())
    return openV4l2Camera(color, "", fps);
  const bool is_empty = !are_numbers && (comma == 0 || comma + 1 == nodes.size());
  if (comma == std::string::npos || is_empty) {
    throw SourceError(spec + ": colour and depth are needed; use " +
                      (are_numbers ? "camera:N,M with two camera numbers"
                                   : "v4l2:COLOR,DEPTH with two nodes, for example "
                                     "v4l2:/dev/video4,/dev/video2"));
  }
  return openV4l2Camera(color, find(nodes.substr(comma + 1)), fps,
                        layout.depth_unit_mm.value_or(1.0));
}

/// Throws SourceError for a kind of source that the server does not read.
void refuseOtherKinds(const std::string& spec) {
  if (isAddress(spec)) {
    throw SourceError(hideCredentials(spec) +
                      ": is an address that the server does not read; use " + kStreamSchemes +
                      ", or download the video first");
  }
}

bool isFile(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool isFolder(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::unique_ptr<RgbdSource> openFolder(const std::string& folder, double fps, bool to_and_fro,
                                       const VideoLayout& layout) {
  auto video = layout.color_glob.empty() ? openVideoFolder(folder, fps, layout) : nullptr;
  if (video == nullptr) return std::make_unique<ImageSequence>(folder, fps, to_and_fro, layout);
  if (to_and_fro)
    throw SourceError(folder +
                      ": has a video, but only images play --to-and-fro; use --loop alone");
  return video;
}

/// Opens a colour video whose depth is one array.
std::unique_ptr<RgbdSource> openVideoWithArray(const std::string& color, const std::string& depth,
                                               double fps, const VideoLayout& layout) {
  if (layout.code == DepthCode::kHue)
    throw SourceError(depth + ": is an array, which has no hues; leave --depth-code out");
  auto video = std::make_unique<VideoFile>(color);
  auto array = std::make_unique<NpyStack>(depth);
  VideoDepthFacts facts;
  facts.name = fileName(color);
  facts.fps = fps;
  facts.layout = layout;
  return std::make_unique<VideoWithDepth>(std::move(video), std::move(array), std::move(facts));
}

std::unique_ptr<RgbdSource> openPair(const std::string& spec, double fps,
                                     const VideoLayout& layout) {
  // File names may contain commas: prefers the split at which both exist.
  std::size_t comma = spec.find(',');
  for (std::size_t at = comma; at != std::string::npos; at = spec.find(',', at + 1)) {
    const std::string depth = spec.substr(at + 1);
    if (isFile(spec.substr(0, at)) && (isFile(depth) || isFolder(depth))) comma = at;
  }
  const std::string color = spec.substr(0, comma);
  const std::string depth = spec.substr(comma + 1);
  if (color.empty() || depth.empty()) {
    throw SourceError(spec + ": one of the two videos is missing; use COLOR,DEPTH");
  }
  if (isFile(color) && isFolder(depth)) return openVideoWithDepth(color, depth, fps, layout);
  if (isArrayName(depth)) return openVideoWithArray(color, depth, fps, layout);
  return std::make_unique<VideoClip>(color, depth, fps, layout);
}

/// Returns whether `spec` has the form of two files.
bool isPair(const std::string& spec) { return spec.find(',') != std::string::npos; }

/// Throws SourceError if the source has no colour that could be read alone.
void requireColor(const std::string& spec, bool is_video) {
  const char* problem = "";
  if (is_video && isFile(spec) && isRecordingFile(spec)) problem = "is a recording with depth";
  if (spec.starts_with(kOpenni)) problem = "is a camera with depth";
  if (!isFile(spec) && isPair(spec)) problem = "names the depth, too";
  if (*problem != '\0')
    throw SourceError(hideCredentials(spec) + ": " + problem +
                      "; leave --depth-from out, or name a source of colour alone");
}

/// Throws SourceError for flags about depth that this source cannot obey.
void requireFlags(const std::string& spec, bool is_video, bool is_named,
                  const VideoLayout& layout) {
  if (layout.color_only) return requireColor(spec, is_video);
  std::error_code error;
  const bool folder = fs::is_directory(spec, error);
  const bool recording = is_video && isFile(spec) && isRecordingFile(spec);
  if (!layout.topics.empty() && !recording)
    throw SourceError(hideCredentials(spec) +
                      ": only a recording (MCAP) has --topics; leave the flag out");
  if (!layout.color_glob.empty() && !folder && (is_video || is_named))
    throw SourceError(hideCredentials(spec) +
                      ": only a folder of images has --color and --depth; leave them out");
  const bool own_unit = spec.starts_with(kSynthetic) || spec.starts_with(kOpenni);
  if (layout.depth_unit_mm && own_unit)
    throw SourceError(hideCredentials(spec) +
                      ": states the unit of its depth itself; leave --depth-unit out");
  const bool inverse_folder = layout.code == DepthCode::kInverse && folder;
  const bool single = is_video && isFile(spec) && !recording;
  if (layout.layout != Layout::kSeparate && !single)
    throw SourceError(hideCredentials(spec) +
                      ": only a single video file has a --layout; leave the flag out");
  if (layout.code != DepthCode::kGrey && (!is_video || recording) && !inverse_folder) {
    throw SourceError(hideCredentials(spec) +
                      ": cannot obey --depth-near dark or --depth-code (hue: only videos; inverse: "
                      "videos and folders); leave the flag out");
  }
}

std::unique_ptr<RgbdSource> openSingle(const std::string& file, double fps,
                                       const VideoLayout& layout) {
  std::unique_ptr<VideoFile> video;
  try {
    video = std::make_unique<VideoFile>(file);
  } catch (const NoVideoError&) {
    if (layout.layout != Layout::kSeparate || layout.color_only) throw;
    throw SourceError(file +
                      ": is a single file; depth is needed too, so use COLOR,DEPTH or a folder");
  }
  return std::make_unique<VideoClip>(std::move(video), layout, fps);
}

std::unique_ptr<RgbdSource> openLive(const std::string& url, double fps, bool to_and_fro,
                                     const VideoLayout& layout) {
  if (to_and_fro) throw SourceError("--to-and-fro: a live stream has one direction; leave it out");
  if (url.find("://", url.find("://") + 1) != std::string::npos) {
    throw SourceError(
        "two streams have no common clock, so their frames cannot be paired; send colour and depth "
        "as one stream (two tracks, or two halves of the picture with --layout)");
  }
  return openNetworkStream(url, layout, fps);
}

}  // namespace

std::string fileName(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);  // resolves "." and "clip/"
  return (error ? path : whole).filename().string();
}

std::unique_ptr<RgbdSource> openSource(const std::string& named, double fps, bool to_and_fro,
                                       const VideoLayout& layout) {
  if (fps != 0.0 && !(fps >= 1.0 && fps <= 240.0)) {
    throw SourceError("frame rate " + std::to_string(fps) + ": allowed is 1 to 240 per second");
  }
  const std::string bag = isFolder(named) ? findBagFile(named) : "";
  const std::string& spec = bag.empty() ? named : bag;
  const std::string_view view = spec;
  if (isStreamUrl(spec)) return openLive(spec, fps, to_and_fro, layout);
  std::error_code error;
  const bool is_folder = fs::is_directory(spec, error);
  if (to_and_fro && !is_folder)
    throw SourceError(hideCredentials(spec) +
                      ": only a folder of images plays --to-and-fro; use --loop alone");
  const bool is_named = view.starts_with(kSynthetic) || view.starts_with(kCamera) ||
                        view.starts_with(kOpenni) || view.starts_with(kV4l2);
  refuseOtherKinds(spec);
  requireFlags(spec, !is_named && (isFile(spec) || isPair(spec)), is_named, layout);
  if (view.starts_with(kSynthetic)) return openSynthetic(view.substr(kSynthetic.size()), fps);
  if (view.starts_with(kCamera))
    return openNodes(spec, spec.substr(kCamera.size()), true, fps, layout);
  if (view.starts_with(kV4l2))
    return openNodes(spec, spec.substr(kV4l2.size()), false, fps, layout);
  if (view.starts_with(kOpenni)) return openOpenniCamera(spec.substr(kOpenni.size()), fps);
  if (is_folder) return openFolder(spec, fps, to_and_fro, layout);
  if (isFile(spec)) {
    if (isRecordingFile(spec)) return std::make_unique<RecordingSource>(spec, fps, layout);
    if (layout.layout == Layout::kSeparate) refuseKnownFile(spec);
    return openSingle(spec, fps, layout);
  }
  if (isPair(spec)) return openPair(spec, fps, layout);
  throw SourceError(
      (spec.empty() ? "(empty source)" : hideCredentials(spec)) +
      ": no such file or folder; use synthetic:NAME, a folder, COLOR,DEPTH, camera:N,M or the "
      "address of a stream");
}

}  // namespace hapticast::server
