// SPDX-License-Identifier: MIT
#include "tests/v4l2/kernel.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <string_view>

#include "tests/support/waiting.hpp"

namespace hapticast::testing {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;
constexpr auto kPeriod = std::chrono::microseconds(1'000'000 / kNodeFps);

/// One open() of a node.
struct OpenNode {
  bool is_depth = false;
  bool gone = false;  // unplugged since
  bool streams = false;
  std::uint64_t number = 0;  // of the last frame
  std::deque<std::uint32_t> queued;
  std::deque<v4l2_buffer> done;
};

std::mutex mutex;  // of all below
std::array<NodeOrders, 2> orders;
std::map<int, OpenNode> open_nodes;  // by file descriptor; entries of closed files are replaced

std::uint32_t rowBytes(const NodeOrders& node) { return 2 * node.width_px + node.gap_bytes; }
std::uint32_t imageBytes(const NodeOrders& node) { return rowBytes(node) * node.height_px; }
std::uint32_t bufferBytes(const NodeOrders& node) { return (imageBytes(node) + 4095U) & ~4095U; }

std::vector<std::uint8_t> draw(const NodeOrders& node, bool is_depth, std::uint64_t number) {
  std::vector<std::uint8_t> bytes(imageBytes(node), 0xEE);
  const int value = is_depth ? depthOf_mm(number) : 0x8000 | brightnessOf(number);
  for (std::uint32_t y = 0; y < node.height_px; ++y) {
    for (std::uint32_t x = 0; x < node.width_px; ++x) {
      bytes[y * rowBytes(node) + 2 * x] = static_cast<std::uint8_t>(value & 0xFF);
      bytes[y * rowBytes(node) + 2 * x + 1] = static_cast<std::uint8_t>(value >> 8);
    }
  }
  return bytes;
}

/// Fills buffers with the frames that are due; without a free buffer a frame is lost.
void advance(int fd, OpenNode& node) {
  const NodeOrders& order = orders.at(node.is_depth ? 1 : 0);
  for (; node.streams && !node.gone && node.number < nodeFrames(); ++node.number) {
    if (!order.delivers || node.queued.empty()) continue;
    v4l2_buffer buffer{};
    buffer.index = node.queued.front();
    node.queued.pop_front();
    const std::uint64_t number = node.number + 1;
    const auto image = draw(order, node.is_depth, number);
    (void)!::pwrite(fd, image.data(), image.size(),
                    static_cast<off_t>(buffer.index) * bufferBytes(order));
    buffer.bytesused = order.used_bytes != 0 ? order.used_bytes : imageBytes(order);
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    const auto stamp_us = static_cast<std::int64_t>(number) * kPeriod.count();
    buffer.timestamp = {stamp_us / 1'000'000, stamp_us % 1'000'000};
    node.done.push_back(buffer);
  }
}

int fail(int error) {
  errno = error;
  return -1;
}

int setFormat(v4l2_format& format, const NodeOrders& order) {
  format.fmt.pix.width = order.width_px;
  format.fmt.pix.height = order.height_px;
  format.fmt.pix.bytesperline = rowBytes(order);
  format.fmt.pix.sizeimage = imageBytes(order);
  return 0;
}

int dequeue(int fd, OpenNode& node, v4l2_buffer& buffer) {
  advance(fd, node);
  if (node.done.empty()) return fail(EAGAIN);
  buffer = node.done.front();
  node.done.pop_front();
  return 0;
}

int answer(int fd, OpenNode& node, unsigned long request, void* argument) {
  const NodeOrders& order = orders.at(node.is_depth ? 1 : 0);
  if (node.gone) return fail(ENODEV);
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      capability.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      capability.capabilities = capability.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& format = *static_cast<v4l2_fmtdesc*>(argument);
      if (format.index >= order.codes.size()) return fail(EINVAL);
      format.pixelformat = order.codes[format.index];
      return 0;
    }
    case VIDIOC_S_FMT:
      return setFormat(*static_cast<v4l2_format*>(argument), order);
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, kNodeFps};
      return 0;
    case VIDIOC_REQBUFS:
      return ::ftruncate(fd, static_cast<off_t>(bufferBytes(order)) *
                                 static_cast<v4l2_requestbuffers*>(argument)->count);
    case VIDIOC_QUERYBUF:
      buffer.length = bufferBytes(order);
      buffer.m.offset = buffer.index * bufferBytes(order);
      return 0;
    case VIDIOC_QBUF:
      node.queued.push_back(buffer.index);
      return 0;
    case VIDIOC_DQBUF:
      return dequeue(fd, node, buffer);
    case VIDIOC_STREAMON:
      node.streams = true;
      node.number = nodeFrames();
      return 0;
    default:
      return fail(ENOTTY);
  }
}

int openNode(bool is_depth) {
  const std::lock_guard lock(mutex);
  if (!orders.at(is_depth ? 1 : 0).plugged) return fail(ENOENT);
  const int fd = ::memfd_create("node", MFD_CLOEXEC);
  open_nodes[fd] = {is_depth, false, false, 0, {}, {}};
  return fd;
}

/// Counts the files that have something to say; -1: not all of them are nodes.
int countReady(pollfd* files, nfds_t count) {
  const std::lock_guard lock(mutex);
  int ready = 0;
  for (nfds_t i = 0; i < count; ++i) {
    const auto node = open_nodes.find(files[i].fd);
    if (node == open_nodes.end()) return -1;
    advance(node->first, node->second);
    files[i].revents = 0;
    if (node->second.gone) files[i].revents = POLLERR;
    if (!node->second.done.empty()) files[i].revents = POLLIN;
    if (files[i].revents != 0) ++ready;
  }
  return ready;
}

}  // namespace

std::uint64_t nodeFrames() {
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch() / kPeriod);
}

void orderNodes(const NodeOrders& color, const NodeOrders& depth) {
  const std::lock_guard lock(mutex);
  orders = {color, depth};
  for (auto& [fd, node] : open_nodes)
    if (!orders.at(node.is_depth ? 1 : 0).plugged) node.gone = true;
}

}  // namespace hapticast::testing

using hapticast::testing::answer;
using hapticast::testing::countReady;
using hapticast::testing::openNode;

extern "C" int open(const char* path, int flags, ...) {
  if (std::string_view(path) == hapticast::testing::kColorNode) return openNode(false);
  if (std::string_view(path) == hapticast::testing::kDepthNode) return openNode(true);
  va_list more;
  va_start(more, flags);
  const int mode = (flags & O_CREAT) != 0 ? va_arg(more, int) : 0;
  va_end(more);
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* const argument = va_arg(more, void*);
  va_end(more);
  const std::lock_guard lock(hapticast::testing::mutex);
  const auto node = hapticast::testing::open_nodes.find(fd);
  if (node != hapticast::testing::open_nodes.end() && _IOC_TYPE(request) == 'V')
    return answer(fd, node->second, request, argument);
  return static_cast<int>(::syscall(SYS_ioctl, fd, request, argument));
}

extern "C" int poll(pollfd* files, nfds_t count, int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  for (;;) {
    const int ready = countReady(files, count);
    if (ready < 0) return static_cast<int>(::syscall(SYS_poll, files, count, timeout_ms));
    if (ready > 0 || std::chrono::steady_clock::now() >= end) return ready;
    hapticast::restBetweenTurns(std::chrono::milliseconds(1));
  }
}
