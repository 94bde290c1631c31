// SPDX-License-Identifier: MIT
// A folder in TUM's layout: whatever its two lists say, findClipFiles() pairs frames or refuses
// them with one line. The bytes up to the first NUL are rgb.txt, the rest is depth.txt.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/source/folder/clip_files.hpp"
#include "server/source/rgbd_source.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::tum {
namespace {

/// Of this process, gone at its end.
struct Folder {
  Folder()
      : path(std::filesystem::temp_directory_path() /
             ("hapticast_tum_fuzz_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::filesystem::path path;
};

}  // namespace

HAPTICAST_FUZZ_TARGET("tum") {
  static const Folder kFolder;
  const std::uint8_t* const end = data + size;
  const std::uint8_t* const split = std::find(data, end, 0);
  std::ofstream(kFolder.path / "rgb.txt", std::ios::binary) << std::string(data, split);
  std::ofstream(kFolder.path / "depth.txt", std::ios::binary)
      << std::string(split == end ? end : split + 1, end);
  try {
    const auto clip = hapticast::server::findClipFiles(kFolder.path);
    require(!clip.frames.empty() && clip.fps >= 1.0 && clip.fps <= 240.0);
    require(clip.mm_per_unit == 0.2 && clip.declared_depth_bits == 16);
    for (const auto& frame : clip.frames) require(!frame.color.empty() && !frame.depth.empty());
  } catch (const hapticast::server::SourceError& error) {
    const std::string line = error.what();
    require(line.starts_with(kFolder.path.string()) && line.find('\n') == std::string::npos);
  }
  return 0;
}

}  // namespace hapticast::fuzz::tum
