// SPDX-License-Identifier: MIT
#include "server/source/child/mask_folder.hpp"

#include <spdlog/spdlog.h>

#include <fstream>
#include <sstream>
#include <utility>

#include "server/source/folder/image_lists.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOriginFile = "mask-from.txt";
constexpr const char* kComplete = "\ncomplete\n";

}  // namespace

MaskFolder::MaskFolder(const fs::path& clip, std::vector<std::string> names, std::string command)
    : folder_(findFolder(clip, {"mask"})), names_(std::move(names)), command_(std::move(command)) {
  std::error_code error;
  if (folder_.empty()) folder_ = clip / "mask";
  if (!fs::exists(folder_, error) || fs::is_empty(folder_, error)) return;
  std::ifstream in(folder_ / kOriginFile, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  complete_ = text.str() == command_ + kComplete;
  if (complete_ || text.str() == command_) return;
  throw SourceError("--mask-from: " + folder_.string() +
                    (in ? " has the masks of another command or of other points"
                        : " has masks of the clip's author") +
                    "; remove that folder, or leave the flag out");
}

void MaskFolder::store(std::uint64_t index, const std::vector<std::uint8_t>& png) {
  if (failed_ || complete_ || index >= names_.size()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  bool written = !answered_.empty() || writeOrigin();
  const fs::path file = folder_ / (names_[index] + ".png");
  if (png.empty()) {
    fs::remove(file, error);
  } else {
    const fs::path part = folder_ / (names_[index] + ".png.part");  // no picture until it is whole
    std::ofstream out(part, std::ios::binary);
    out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
    out.close();
    fs::rename(part, file, error);
    written = written && out.good() && !error;
  }
  answered_.insert(index);
  complete_ = answered_.size() == names_.size();
  if (complete_) written = writeOrigin() && written;
  if (written) return;
  failed_ = true;
  complete_ = false;
  spdlog::warn("--mask-from: {} cannot be written; the masks are not kept", folder_.string());
}

bool MaskFolder::writeOrigin() const {
  std::ofstream out(folder_ / kOriginFile, std::ios::binary);
  out << command_ << (complete_ ? kComplete : "");
  out.close();
  return out.good();
}

}  // namespace hapticast::server
