// SPDX-License-Identifier: MIT
// Two nodes of Video4Linux2 where the machine has none: this program's own open(), ioctl() and
// poll() answer for them in the kernel's place. The memory of the buffers is real. Every frame has
// its number as its content. Thread: any.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hapticast::testing {

/// Properties and behaviour of an emulated node.
struct NodeOrders {
  bool plugged = true;
  bool delivers = true;
  std::vector<std::uint32_t> codes;  ///< its formats
  std::uint32_t width_px = 64;
  std::uint32_t height_px = 48;
  std::uint32_t gap_bytes = 0;   ///< behind each row
  std::uint32_t used_bytes = 0;  ///< bytesused, if it is false; 0: the true number
};

inline constexpr const char* kColorNode = "/dev/video-test-color";
inline constexpr const char* kDepthNode = "/dev/video-test-depth";
inline constexpr int kNodeFps = 50;

/// Sets what the colour node and the depth node do. An unplugged one stays gone for those who have
/// it open.
void orderNodes(const NodeOrders& color, const NodeOrders& depth);

/// Number of the frame that the nodes are at.
std::uint64_t nodeFrames();

/// Depth of every pixel of frame `number`, mm; and the brightness (Y of YUV) of its colour.
constexpr int depthOf_mm(std::uint64_t number) { return 1000 + static_cast<int>(number % 100); }
constexpr int brightnessOf(std::uint64_t number) { return 16 + 2 * static_cast<int>(number % 100); }

}  // namespace hapticast::testing
