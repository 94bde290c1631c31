// SPDX-License-Identifier: MIT
// Answers of the user's programs: whatever a child writes, DepthTask and MaskTask set pictures of
// the frame's size or describe the problem. The first byte chooses the task, the first line is the
// header, and the rest is repeated as its bytes. The cache loads the same bytes as a damaged file.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "server/source/child/depth_task.hpp"
#include "server/source/child/mask_task.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::child {
namespace {

using namespace hapticast::server;

constexpr std::size_t kMostBytes = std::size_t{1} << 16U;  // larger answers cost time only

void applyTo(ChildTask& task, const ChildAnswer& answer) {
  RgbdFrame frame;
  frame.color = cv::Mat(6, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  const std::string problem = task.apply(frame, answer);
  require(problem.find('\n') == std::string::npos);
  require(frame.depth.empty() ||
          (frame.depth.size() == frame.color.size() && frame.depth.type() == CV_32FC1 &&
           cv::checkRange(frame.depth, true, nullptr, 0.0, 1e8)));
  require(frame.mask.empty() ||
          (frame.mask.size() == frame.color.size() && cv::countNonZero(frame.mask) > 0));
}

/// A cache in a folder of this process, gone at its end.
struct Cache {
  ~Cache() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                 ("hapticast_child_fuzz_" + std::to_string(::getpid()));
  DepthCache cache{folder, 1.0, "clip"};
};

void loadDamaged(const std::uint8_t* data, std::size_t size) {
  static Cache kept;
  static bool stored = false;
  if (!stored) kept.cache.store(0, {"1 1 metric_mm", {0, 0, 0, 0}});
  stored = true;
  for (const auto& file : std::filesystem::recursive_directory_iterator(kept.folder)) {
    if (!file.is_regular_file()) continue;
    std::ofstream(file.path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  (void)kept.cache.load(0);
}

}  // namespace

HAPTICAST_FUZZ_TARGET("child") {
  if (size == 0) return 0;
  const std::uint8_t* const end = data + size;
  const std::uint8_t* const line_end = std::find(data + 1, end, '\n');
  ChildAnswer answer{std::string(data + 1, line_end), {}};
  DepthTask depth("", kRelativeRange, nullptr);
  MaskTask mask("", {}, nullptr);
  ChildTask& task = data[0] % 2 == 0 ? static_cast<ChildTask&>(depth) : mask;
  const auto bytes = task.measure(answer.header);
  if (bytes && *bytes <= kMostBytes) {
    answer.bytes.resize(*bytes);
    const auto rest = static_cast<std::size_t>(end - line_end);
    for (std::size_t i = 0; i < *bytes; ++i)
      answer.bytes[i] = rest > 1 ? line_end[1 + i % (rest - 1)] : 0;
    applyTo(task, answer);
    applyTo(task, answer);
  }
  if (data[0] >= 128) loadDamaged(data + 1, size - 1);
  return 0;
}

}  // namespace hapticast::fuzz::child
