// SPDX-License-Identifier: MIT
#include "server/source/live/v4l2_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "server/source/live/paired_camera.hpp"
#include "server/source/live/v4l2_picture.hpp"
#include "server/source/owned_descriptor.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/source/scale/depth_scale.hpp"

namespace hapticast::server {

namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr std::uint32_t kWantedWidth_px = 640;
constexpr std::uint32_t kWantedHeight_px = 480;
constexpr std::uint32_t kMostFormats = 64;  // a driver that never ends its list is not trusted

std::string describeErrno() { return std::generic_category().message(errno); }

/// ioctl() that a signal does not interrupt.
template <class Argument>
int control(int fd, unsigned long request, Argument* argument) {
  int result = -1;
  do {
    result = ::ioctl(fd, request, argument);
  } while (result == -1 && errno == EINTR);
  return result;
}

/// Memory that the kernel fills with a picture.
class MappedBuffer {
 public:
  MappedBuffer(int fd, const v4l2_buffer& buffer)
      : bytes_(buffer.length),
        memory_(::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd,
                       static_cast<off_t>(buffer.m.offset))) {}
  ~MappedBuffer() {
    if (valid()) ::munmap(memory_, bytes_);
  }
  MappedBuffer(MappedBuffer&& other) noexcept
      : bytes_(other.bytes_), memory_(std::exchange(other.memory_, MAP_FAILED)) {}
  MappedBuffer& operator=(MappedBuffer&&) = delete;

  [[nodiscard]] bool valid() const { return memory_ != MAP_FAILED; }
  /// Returns the first `used` bytes, and never more than there are.
  [[nodiscard]] std::span<const std::uint8_t> first(std::size_t used) const {
    return {static_cast<const std::uint8_t*>(memory_), std::min(used, bytes_)};
  }

 private:
  std::size_t bytes_;
  void* memory_;
};

/// An open node that captures.
class V4l2Node {
 public:
  V4l2Node(std::string path, bool is_depth, double fps);
  // The kernel stops the capture when the file is closed.

  [[nodiscard]] const V4l2Format& format() const { return format_; }
  [[nodiscard]] double fps() const { return fps_; }
  [[nodiscard]] cv::Size size() const {
    return {static_cast<int>(format_.width_px), static_cast<int>(format_.height_px)};
  }
  [[nodiscard]] int fd() const { return file_.get(); }
  /// Returns the newest picture that waits, or nullopt. Throws SourceError if the node is gone.
  std::optional<LivePicture> takeNewest();

 private:
  void checkNode();
  void setFormat();
  void setRate(double fps);
  void start();
  [[nodiscard]] LivePicture convert(const v4l2_buffer& buffer) const;
  void queue(std::uint32_t index);
  [[noreturn]] void fail(const std::string& what) const { throw SourceError(path_ + ": " + what); }

  std::string path_;
  bool is_depth_;
  OwnedDescriptor file_;
  V4l2Format format_;
  double fps_ = 30.0;
  std::vector<MappedBuffer> buffers_;
};

V4l2Node::V4l2Node(std::string path, bool is_depth, double fps)
    : path_(std::move(path)),
      is_depth_(is_depth),
      file_(::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (fd() < 0)
    fail("cannot be opened (" + describeErrno() + "); the cameras of this machine are /dev/video*");
  checkNode();
  setFormat();
  setRate(fps);
  start();
}

void V4l2Node::checkNode() {
  v4l2_capability capability{};
  if (control(fd(), VIDIOC_QUERYCAP, &capability) == -1)
    fail("is no camera; the cameras of this machine are /dev/video*");
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                ? capability.device_caps
                                : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    fail("captures no pictures; choose another node of the camera");
}

// Chooses the first known format that the node lists, in the size that is nearest to 640x480.
void V4l2Node::setFormat() {
  std::vector<std::uint32_t> listed;
  for (std::uint32_t i = 0; i < kMostFormats; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (control(fd(), VIDIOC_ENUM_FMT, &description) == -1) break;
    listed.push_back(description.pixelformat);
  }
  const std::span<const std::uint32_t> known =
      is_depth_ ? std::span<const std::uint32_t>(kDepthCodes) : kColorCodes;
  const auto code = std::find_first_of(known.begin(), known.end(), listed.begin(), listed.end());
  if (code == known.end())
    fail(is_depth_ ? "delivers no depth (Z16, Y16 or grey); choose the depth node of the camera"
                   : "delivers no colour (YUYV, NV12, RGB or MJPEG); choose the colour node");
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = kWantedWidth_px;
  format.fmt.pix.height = kWantedHeight_px;
  format.fmt.pix.pixelformat = *code;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (control(fd(), VIDIOC_S_FMT, &format) == -1)
    fail("refuses its own format (" + describeErrno() + "); is it used by another program?");
  const v4l2_pix_format& pix = format.fmt.pix;
  const bool compressed =
      pix.pixelformat == V4L2_PIX_FMT_MJPEG || pix.pixelformat == V4L2_PIX_FMT_JPEG;
  format_ = {pix.pixelformat, pix.width, pix.height, compressed ? 0 : pix.bytesperline};
  if (pix.pixelformat != *code) fail("refuses its own format");
  if (!sizeAllowed(static_cast<int>(pix.width), static_cast<int>(pix.height)))
    fail("delivers " + std::to_string(pix.width) + "x" + std::to_string(pix.height) +
         "; allowed is up to 1920x1080");
}

void V4l2Node::setRate(double fps) {
  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (fps > 0.0) {
    rate.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000.0 * fps))};
    (void)control(fd(), VIDIOC_S_PARM, &rate);
  }
  if (control(fd(), VIDIOC_G_PARM, &rate) == -1) return;
  const v4l2_fract& period = rate.parm.capture.timeperframe;
  const double claimed = double{static_cast<double>(period.denominator)} / period.numerator;
  if (claimed >= 1.0 && claimed <= 240.0) fps_ = claimed;
}

void V4l2Node::start() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (control(fd(), VIDIOC_REQBUFS, &request) == -1 || request.count < 2)
    fail("cannot capture (" + describeErrno() + "); is it used by another program?");
  for (std::uint32_t i = 0; i < std::min(request.count, kBuffers); ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (control(fd(), VIDIOC_QUERYBUF, &buffer) == -1) fail("cannot capture");
    buffers_.emplace_back(fd(), buffer);
    if (!buffers_.back().valid()) fail("cannot capture (" + describeErrno() + ")");
    queue(i);
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (control(fd(), VIDIOC_STREAMON, &type) == -1)
    fail("cannot capture (" + describeErrno() + "); is it used by another program?");
}

void V4l2Node::queue(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (control(fd(), VIDIOC_QBUF, &buffer) == -1) fail("was unplugged (" + describeErrno() + ")");
}

std::optional<LivePicture> V4l2Node::takeNewest() {
  std::optional<v4l2_buffer> newest;
  for (std::uint32_t i = 0; i < 2 * kBuffers; ++i) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (control(fd(), VIDIOC_DQBUF, &buffer) == -1) {
      if (errno == EAGAIN) break;
      fail("was unplugged (" + describeErrno() + ")");
    }
    if (buffer.index >= buffers_.size()) fail("delivers a buffer that it does not have");
    if (newest) queue(newest->index);
    newest = buffer;
  }
  if (!newest) return std::nullopt;
  LivePicture picture = convert(*newest);
  queue(newest->index);
  return picture;
}

LivePicture V4l2Node::convert(const v4l2_buffer& buffer) const {
  LivePicture picture{is_depth_, SteadyClock().now(), {}, ""};
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
    picture.time = LocalTime(std::chrono::seconds(buffer.timestamp.tv_sec) +
                             std::chrono::microseconds(buffer.timestamp.tv_usec));
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
    picture.problem = path_ + ": delivers a damaged picture";
    return picture;
  }
  const auto bytes = buffers_[buffer.index].first(buffer.bytesused);
  ImageResult result = is_depth_ ? readV4l2Depth(format_, bytes) : readV4l2Color(format_, bytes);
  picture.image = result.image;
  if (!result.ok()) picture.problem = path_ + ": " + result.problem;
  return picture;
}

/// The two nodes of a camera.
class V4l2Device final : public PictureCamera {
 public:
  V4l2Device(const std::string& color, const std::string& depth, double fps, double mm_per_unit);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] bool hasDepth() const override { return depth_ != nullptr; }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    if (!hasDepth()) return {};
    return {info_.name +
            ": depth is not registered to colour, unless the camera does so itself; shapes and "
            "colours of edges are displaced"};
  }
  std::optional<LivePicture> read(Duration longest) override;

 private:
  void describeDepth(const std::string& color, const std::string& depth, double mm_per_unit);

  V4l2Node color_;
  std::unique_ptr<V4l2Node> depth_;  // null: colour only
  SourceInfo info_;
};

V4l2Device::V4l2Device(const std::string& color, const std::string& depth, double fps,
                       double mm_per_unit)
    : color_(color, false, fps) {
  const cv::Size size = color_.size();
  info_.name = "v4l2:" + fileName(color);
  info_.width_px = size.width;
  info_.height_px = size.height;
  info_.fps = color_.fps();
  if (depth.empty()) return;
  depth_ = std::make_unique<V4l2Node>(depth, true, fps);
  describeDepth(color, depth, mm_per_unit);
}

void V4l2Device::describeDepth(const std::string& color, const std::string& depth,
                               double mm_per_unit) {
  const cv::Size size = color_.size();
  const cv::Size depth_size = depth_->size();
  if (!isSameAspect(size, depth_size))
    throw SourceError(depth + ": delivers " + sizeText(depth_size.width, depth_size.height) +
                      ", another shape than " + color + " with " +
                      sizeText(size.width, size.height));
  info_.name += "," + fileName(depth);
  info_.fps = std::min(color_.fps(), depth_->fps());
  info_.depth_kind = findDepthKind(depth_->format().code);
  info_.mm_per_unit = mm_per_unit;
  if (mm_per_unit != 1.0 && info_.depth_kind != DepthKind::kMetric)
    throw SourceError(depth + ": has depth of 8 bits, which are heights; leave --depth-unit out");
}

std::optional<LivePicture> V4l2Device::read(Duration longest) {
  // poll() ignores a negative descriptor.
  std::array<pollfd, 2> files{
      {{color_.fd(), POLLIN, 0}, {hasDepth() ? depth_->fd() : -1, POLLIN, 0}}};
  const auto wait_ms = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
  if (::poll(files.data(), files.size(), static_cast<int>(wait_ms)) <= 0) return std::nullopt;
  // An error shows itself as the error of the next call.
  if (files[0].revents != 0)
    if (auto picture = color_.takeNewest()) return picture;
  if (files[1].revents == 0) return std::nullopt;
  auto picture = depth_->takeNewest();
  if (picture && picture->problem.empty() && info_.mm_per_unit != 1.0)
    picture->image = picture->image * info_.mm_per_unit;
  return picture;
}

}  // namespace

std::unique_ptr<RgbdSource> openV4l2Camera(const std::string& color, const std::string& depth,
                                           double fps, double mm_per_unit) {
  return openPairedCamera(
      [=] { return std::make_unique<V4l2Device>(color, depth, fps, mm_per_unit); });
}

}  // namespace hapticast::server
