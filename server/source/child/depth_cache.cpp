// SPDX-License-Identifier: MIT
#include "server/source/child/depth_cache.hpp"

#include <openssl/evp.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr const char* kEnding = ".depth";
constexpr const char* kPartEnding = ".part";
constexpr std::size_t kName_digits = 64;                 // of SHA-256
constexpr int kLevel = 1;                                // of zstd: measured, 4 ms for 640 x 480 px
constexpr std::uint64_t kMostAnswer_bytes = 80'000'000;  // a little above 4096 x 4096 floats

std::string hashToHex(const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw SourceError("--depth-cache: SHA-256 is not available");
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

/// A clip in the cache.
struct CachedClip {
  fs::path folder;
  fs::file_time_type used;
  std::uint64_t bytes = 0;
};

/// Returns whether `name` is that of a clip. The cache leaves other folders alone.
bool isClipName(const std::string& name) {
  return name.size() == kName_digits &&
         name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::vector<CachedClip> listClips(const fs::path& folder) {
  std::vector<CachedClip> clips;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.symlink_status(error).type() != fs::file_type::directory ||
        !isClipName(entry.path().filename().string()))
      continue;
    CachedClip clip{entry.path(), entry.last_write_time(error), 0};
    for (const fs::directory_entry& file : fs::directory_iterator(entry.path(), error)) {
      const std::uintmax_t size = file.file_size(error);
      if (!error) clip.bytes += size;
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

void deleteClip(const CachedClip& clip) {
  std::error_code error;
  for (const fs::directory_entry& file : fs::directory_iterator(clip.folder, error)) {
    const fs::path ending = file.path().extension();
    if (ending == kEnding || ending == kPartEnding) fs::remove(file.path(), error);
  }
  fs::remove(clip.folder, error);
}

void describeFile(const fs::path& file, std::ostringstream& text) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error).time_since_epoch().count();
  text << fs::canonical(file, error).string() << ' ' << fs::file_size(file, error) << ' ' << time
       << '\n';
}

}  // namespace

std::string describeCachedClip(const std::string& spec, const std::vector<fs::path>& files,
                               const SourceInfo& info, const std::string& command) {
  std::ostringstream text;
  text << command << '\n' << info.width_px << ' ' << info.height_px << '\n';
  if (files.empty()) text << spec << ' ' << info.fps << '\n';
  for (const fs::path& file : files) describeFile(file, text);
  return text.str();
}

DepthCache::DepthCache(const fs::path& folder, double limit_GB, const std::string& clip)
    : folder_(folder),
      clip_folder_(folder / hashToHex(clip)),
      limit_bytes_(static_cast<std::uint64_t>(limit_GB * 1e9)) {
  std::error_code error;
  fs::create_directories(clip_folder_, error);
  if (error)
    throw SourceError("--depth-cache " + folder.string() + ": cannot be written (" +
                      error.message() + "); name a folder that you may write");
  fs::last_write_time(clip_folder_, fs::file_time_type::clock::now(), error);
  for (const CachedClip& each : listClips(folder_)) used_bytes_ += each.bytes;
}

fs::path DepthCache::file(std::uint64_t index) const {
  return clip_folder_ / (fmt::format("{:06}", index) + kEnding);
}

std::optional<ChildAnswer> DepthCache::load(std::uint64_t index) const {
  std::error_code error;
  const fs::path path = file(index);
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kMostAnswer_bytes)
    return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> packed{std::istreambuf_iterator<char>(in), {}};
  const auto size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size > kMostAnswer_bytes) return std::nullopt;  // also what zstd returns for an error
  std::vector<std::uint8_t> bytes(size);
  if (ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()) != size)
    return std::nullopt;
  const auto end = std::find(bytes.begin(), bytes.end(), '\n');
  if (end == bytes.end()) return std::nullopt;
  return ChildAnswer{std::string(bytes.begin(), end), {end + 1, bytes.end()}};
}

void DepthCache::store(std::uint64_t index, const ChildAnswer& answer) {
  if (warned_) return;
  std::vector<std::uint8_t> bytes(answer.header.begin(), answer.header.end());
  bytes.push_back('\n');
  bytes.insert(bytes.end(), answer.bytes.begin(), answer.bytes.end());
  std::vector<char> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0U) return;
  if (!makeRoom(size)) return warnOnce("is full with this clip; give it a larger limit");
  const fs::path path = file(index);
  fs::path part = path;
  part += std::to_string(::getpid()) + kPartEnding;
  std::ofstream out(part, std::ios::binary);
  out.write(packed.data(), static_cast<std::streamsize>(size));
  out.close();
  std::error_code error;
  if (out) fs::rename(part, path, error);
  if (!out || error) {
    fs::remove(part, error);
    return warnOnce("cannot be written; the depth is not kept");
  }
  used_bytes_ += size;
}

bool DepthCache::makeRoom(std::uint64_t bytes) {
  if (used_bytes_ + bytes <= limit_bytes_) return true;
  std::vector<CachedClip> clips = listClips(folder_);
  std::sort(clips.begin(), clips.end(),
            [](const CachedClip& a, const CachedClip& b) { return a.used < b.used; });
  used_bytes_ = 0;
  for (const CachedClip& clip : clips) used_bytes_ += clip.bytes;
  for (const CachedClip& clip : clips) {
    if (used_bytes_ + bytes <= limit_bytes_) return true;
    if (clip.folder == clip_folder_) continue;
    deleteClip(clip);
    used_bytes_ -= clip.bytes;
  }
  return used_bytes_ + bytes <= limit_bytes_;
}

void DepthCache::warnOnce(const std::string& problem) {
  if (!std::exchange(warned_, true))
    spdlog::warn("--depth-cache {}: {}", folder_.string(), problem);
}

}  // namespace hapticast::server
