// SPDX-License-Identifier: MIT
// Runs a fuzz target over every file of a folder: what a fuzzer has found stays found.
//   fuzz_replay TARGET FOLDER
// Fails on an empty folder.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz {
namespace {

std::map<std::string, Target>& table() noexcept {
  static std::map<std::string, Target> targets;
  return targets;
}

std::vector<char> readFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the exit code.
int replay(const std::string& name, const std::filesystem::path& folder) {
  const auto target = table().find(name);
  if (target == table().end()) throw std::runtime_error("there is no target " + name);
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::vector<char> bytes = readFile(file.path());
    target->second(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ++count;
  }
  std::printf("%s: %d inputs\n", name.c_str(), count);
  return count > 0 ? 0 : 1;
}

}  // namespace

bool addTarget(const char* name, Target target) noexcept {
  table().emplace(name, target);
  return true;
}

}  // namespace hapticast::fuzz

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: fuzz_replay TARGET FOLDER\n", stderr);
    return 2;
  }
  try {
    return hapticast::fuzz::replay(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
