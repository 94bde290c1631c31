// SPDX-License-Identifier: MIT
// Runs a fuzz target over files and over every file of corpus folders: what a fuzzer has found
// stays found. Fails on an empty folder.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

/// False where there is no such file.
bool replayFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return false;
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return true;
}

/// Replays files and all files of folders; the exit code.
int replay(const std::vector<std::filesystem::path>& paths) {
  int count = 0;
  for (const auto& path : paths) {
    std::vector<std::filesystem::path> files{path};
    if (std::filesystem::is_directory(path)) {
      files.assign(std::filesystem::directory_iterator(path), {});
    }
    for (const auto& file : files) {
      if (!replayFile(file)) {
        std::fprintf(stderr, "%s cannot be read\n", file.c_str());
        return 2;
      }
      ++count;
    }
  }
  std::printf("%d inputs\n", count);
  return count > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return replay({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
