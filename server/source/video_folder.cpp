// SPDX-License-Identifier: MIT
#include "server/source/video_folder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/text.hpp"
#include "server/source/folder/clip_meta.hpp"
#include "server/source/folder/depth_folder.hpp"
#include "server/source/folder/image_lists.hpp"
#include "server/source/folder/text_file.hpp"
#include "server/source/video/video_clip.hpp"
#include "server/source/video/video_with_depth.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 3> kColorVideos{"rgb", "color", "colour"};
constexpr std::array<std::string_view, 6> kVideoEndings{".mp4",  ".mov", ".mkv",
                                                        ".webm", ".avi", ".m4v"};

template <std::size_t count>
bool isOneOf(const std::array<std::string_view, count>& names, const std::string& text) {
  return std::find(names.begin(), names.end(), toLower(text)) != names.end();
}

/// What a folder has at its top.
struct Content {
  std::vector<fs::path> videos;
  fs::path color_folder;  ///< empty: none
  fs::path depth_folder;  ///< empty: none
};

Content listContent(const fs::path& folder) {
  Content content{{}, findColorFolder(folder), findDepthFolder(folder)};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string();
    if (!entry.is_directory() && name.front() != '.' &&
        isOneOf(kVideoEndings, path.extension().string())) {
      content.videos.push_back(path);
    }
  }
  return content;
}

/// Returns the colour video among `videos`. Throws SourceError if that is not clear.
fs::path chooseVideo(const std::vector<fs::path>& videos, const fs::path& folder) {
  if (videos.size() == 1) return videos.front();
  std::vector<fs::path> named;
  for (const fs::path& video : videos) {
    if (isOneOf(kColorVideos, video.stem().string())) named.push_back(video);
  }
  if (named.size() == 1) return named.front();
  throw SourceError(folder.string() + ": has " + std::to_string(videos.size()) +
                    " videos; name the colour video of depth/ rgb.mp4");
}

/// Returns the camera in the rows of a 3x3 matrix: fx, 0, cx; 0, fy, cy; 0, 0, 1. Throws
/// SourceError.
CameraModel readCameraMatrix(const fs::path& file) {
  std::vector<double> values;
  std::string word;
  bool numbers = true;
  for (const char c : readText(file) + "\n") {
    const bool ends = c == ',' || c == ';' || std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!ends) word += c;
    if (!ends || word.empty()) continue;
    const auto value = parseNumber(std::exchange(word, ""));
    numbers = numbers && value.has_value() && values.size() < 9;
    if (!numbers) break;
    values.push_back(*value);
  }
  constexpr double kMost_px = 1e5;
  const bool valid = numbers && values.size() == 9 && std::min(values[0], values[4]) >= 1.0 &&
                     std::max(values[0], values[4]) <= kMost_px &&
                     std::max(std::abs(values[2]), std::abs(values[5])) <= kMost_px;
  if (!valid) {
    throw SourceError(file.string() +
                      ": is no 3 x 3 matrix of intrinsics (fx, 0, cx, 0, fy, cy, 0, 0, 1), with fx "
                      "and fy from 1 to 100000 px; correct or remove it");
  }
  return {values[0], values[4], values[2] + 0.5, values[5] + 0.5};
}

/// Opens the video and its depth. `folder`: with meta.json; empty: there is none.
std::unique_ptr<RgbdSource> join(const fs::path& color, const fs::path& depth,
                                 const fs::path& folder, double fps, const VideoLayout& layout) {
  auto video = std::make_unique<VideoFile>(color.string());
  const std::uint64_t frames = video->tracks().front().frame_count;
  VideoDepthFacts facts;
  facts.name = fileName(folder.empty() ? color : folder);
  facts.layout = layout;
  if (!folder.empty() && fs::exists(folder / "meta.json")) {
    const fs::path file = folder / "meta.json";
    const ClipMeta meta = parseClipMeta(readText(file), file.string());
    facts.fps = meta.fps.value_or(0.0);
    facts.mm_per_unit = meta.mm_per_unit;
    facts.camera = meta.camera;
    facts.fov_deg = meta.fov_deg;
  }
  if (fps > 0.0) facts.fps = fps;
  const fs::path matrix = fs::absolute(color).parent_path() / "camera_matrix.csv";
  if (!facts.camera && fs::exists(matrix)) facts.camera = readCameraMatrix(matrix);
  const fs::path confidence = fs::canonical(depth).parent_path() / "confidence";
  auto images =
      std::make_unique<DepthFolder>(depth, frames > 0 ? std::optional(frames) : std::nullopt,
                                    fs::is_directory(confidence) ? confidence : fs::path());
  return std::make_unique<VideoWithDepth>(std::move(video), std::move(images), std::move(facts));
}

}  // namespace

std::unique_ptr<RgbdSource> openVideoFolder(const fs::path& folder, double fps,
                                            const VideoLayout& layout) try {
  if (!layout.color_only && fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt"))
    return nullptr;
  const Content content = listContent(folder);
  if (layout.color_only) {
    if (content.videos.empty() || !content.color_folder.empty()) return nullptr;
    return std::make_unique<VideoClip>(
        std::make_unique<VideoFile>(chooseVideo(content.videos, folder).string()), layout, fps);
  }
  if (content.videos.empty() || content.depth_folder.empty() || !content.color_folder.empty())
    return nullptr;
  return join(chooseVideo(content.videos, folder), content.depth_folder, folder, fps, layout);
} catch (const fs::filesystem_error& error) {
  throw SourceError(folder.string() + ": cannot be read (" + error.code().message() + ")");
}

std::unique_ptr<RgbdSource> openVideoWithDepth(const std::string& color, const fs::path& depth,
                                               double fps, const VideoLayout& layout) try {
  return join(color, depth, {}, fps, layout);
} catch (const fs::filesystem_error& error) {
  throw SourceError(depth.string() + ": cannot be read (" + error.code().message() + ")");
}

}  // namespace hapticast::server
