// SPDX-License-Identifier: MIT
#include "server/page/page_folder.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "common/write_file.hpp"
#include "server/page/page_files.hpp"
#include "server/page/page_policy.hpp"

namespace hapticast::server {

namespace {

/// Makes the page play the recording instead of the stream of its server.
std::vector<std::uint8_t> nameRecording(std::vector<std::uint8_t> index) {
  constexpr std::string_view kSource = R"(name="hapticast-source" content="stream")";
  constexpr std::string_view kRecording = R"(name="hapticast-source" content="recording.mcap")";
  std::string text(index.begin(), index.end());
  const std::size_t place = text.find(kSource);
  if (place == std::string::npos) throw std::runtime_error("index.html names no source");
  text.replace(place, kSource.size(), kRecording);
  text.insert(
      place - std::string_view("<meta ").size(),
      fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", kPagePolicy));
  return {text.begin(), text.end()};
}

}  // namespace

void createPageFolder(const std::string& folder) {
  if (!isPageComplete())
    throw std::runtime_error("-o " + folder +
                             ": this build has no page (deploy/install-deps installs what its core "
                             "needs; then build again)");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("-o " + folder + ": " + error.message());
}

void writePageFolder(const std::string& folder) {
  for (const PageFile& file : listPageFiles()) {
    std::vector<std::uint8_t> content = inflate(file);
    if (file.name == "index.html") content = nameRecording(std::move(content));
    const std::string path = folder + std::string(file.name);
    if (const auto error = writeFile(path, content))
      throw std::runtime_error(path + ": " + error->message);
  }
}

}  // namespace hapticast::server
