// SPDX-License-Identifier: MIT
#include "server/source/live/openni_camera.hpp"

#include "common/build_options.hpp"

#if HAPTICAST_OPENNI2

#include <OpenNI.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "server/source/live/paired_camera.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/source/scale/depth_scale.hpp"

namespace hapticast::server {

namespace {

constexpr int kUsualArea_px = 640 * 480;  // chosen: vision keeps up with 30 frames/s of it
constexpr double kUsualRate = 30.0;

/// Returns what OpenNI2 says about its last error, in brackets and as one line, or "".
std::string describeOpenniError() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& c : text)
    if (c == '\n' || c == '\t' || c == '\r') c = ' ';
  const std::size_t end = text.find_last_not_of(' ');
  if (end == std::string::npos) return "";
  return " (" + text.substr(0, std::min<std::size_t>(end + 1, 200)) + ")";
}

/// OpenNI2 as long as this object exists. A new start finds cameras that were plugged in since,
/// with every driver. OpenNI2 changes the working directory of the process while it starts.
class OpenniLibrary {
 public:
  explicit OpenniLibrary(const std::string& name) {
    if (openni::OpenNI::initialize() == openni::STATUS_OK) return;
    const std::string why = describeOpenniError();
    openni::OpenNI::shutdown();  // a failed start counts as one, too
    throw SourceError(name + ": OpenNI2 does not start" + why + "; is a driver installed?");
  }
  ~OpenniLibrary() { openni::OpenNI::shutdown(); }
  OpenniLibrary(const OpenniLibrary&) = delete;
  OpenniLibrary& operator=(const OpenniLibrary&) = delete;
};

/// Returns the URI of the camera that the user named.
std::string findUri(const std::string& device, const std::string& name) {
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  std::size_t number = 0;
  const char* const end = device.data() + device.size();
  const auto parsed = std::from_chars(device.data(), end, number);
  if (!device.empty() && (parsed.ec != std::errc() || parsed.ptr != end)) return device;
  const auto count = static_cast<std::size_t>(std::max(found.getSize(), 0));
  if (count == 0)
    throw SourceError(name + ": no OpenNI2 device was found; plug one in, or check the udev rules");
  if (number >= count)
    throw SourceError(name + ": there are only " + std::to_string(count) +
                      " OpenNI2 device(s), and the first one has the number 0");
  return found[static_cast<int>(number)].getUri();
}

/// Format of both streams.
struct OpenniModes {
  openni::VideoMode color;
  openni::VideoMode depth;
};

std::vector<openni::VideoMode> listModes(const openni::SensorInfo& sensor, bool is_depth) {
  std::vector<openni::VideoMode> modes;
  const auto& all = sensor.getSupportedVideoModes();
  for (int i = 0; i < all.getSize(); ++i) {
    const openni::PixelFormat format = all[i].getPixelFormat();
    const bool known = is_depth ? format == openni::PIXEL_FORMAT_DEPTH_1_MM ||
                                      format == openni::PIXEL_FORMAT_DEPTH_100_UM
                                : format == openni::PIXEL_FORMAT_RGB888;
    if (known && sizeAllowed(all[i].getResolutionX(), all[i].getResolutionY()) &&
        all[i].getFps() >= 1 && all[i].getFps() <= 240)
      modes.push_back(all[i]);
  }
  return modes;
}

cv::Size sizeOf(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY()};
}

/// Returns the best formats: depth and colour of one size first, then a size near 640x480, then the
/// wanted rate. Returns nullopt if no depth has the shape of a colour.
std::optional<OpenniModes> selectModes(const std::vector<openni::VideoMode>& colors,
                                       const std::vector<openni::VideoMode>& depths, double fps) {
  const double wanted = fps > 0.0 ? fps : kUsualRate;
  const auto rate = [&](const OpenniModes& modes) {
    const openni::VideoMode &color = modes.color, &depth = modes.depth;
    const bool other_size = sizeOf(color) != sizeOf(depth);
    return std::tuple(other_size, std::abs(sizeOf(color).area() - kUsualArea_px),
                      -sizeOf(depth).area(), std::abs(color.getFps() - wanted),
                      std::abs(depth.getFps() - wanted),
                      depth.getPixelFormat() != openni::PIXEL_FORMAT_DEPTH_1_MM);
  };
  std::optional<OpenniModes> best;
  for (const openni::VideoMode& color : colors) {
    for (const openni::VideoMode& depth : depths) {
      const OpenniModes modes{color, depth};
      if (isSameAspect(sizeOf(color), sizeOf(depth)) && (!best || rate(modes) < rate(*best)))
        best = modes;
    }
  }
  return best;
}

/// Returns why `frame` is not a whole picture of `mode`, or "".
std::string findFault(const openni::VideoFrameRef& frame, const openni::VideoMode& mode) {
  const cv::Size size = sizeOf(mode);
  if (frame.getWidth() != size.width || frame.getHeight() != size.height)
    return "delivers " + sizeText(frame.getWidth(), frame.getHeight()) + " instead of " +
           sizeText(size.width, size.height);
  if (frame.getVideoMode().getPixelFormat() != mode.getPixelFormat())
    return "delivers another format than it was asked for";
  const bool is_depth = mode.getPixelFormat() != openni::PIXEL_FORMAT_RGB888;
  const std::int64_t row_bytes = std::int64_t{size.width} * (is_depth ? 2 : 3);
  const std::int64_t stride = frame.getStrideInBytes();
  if (stride < row_bytes || stride % (is_depth ? 2 : 1) != 0 ||
      frame.getDataSize() < stride * (size.height - 1) + row_bytes || frame.getData() == nullptr)
    return "delivers incomplete pictures";
  return "";
}

/// Returns the picture of a frame in which findFault() finds nothing.
cv::Mat convertFrame(const openni::VideoFrameRef& frame, const openni::VideoMode& mode) {
  const bool is_depth = mode.getPixelFormat() != openni::PIXEL_FORMAT_RGB888;
  const cv::Mat raw(sizeOf(mode), is_depth ? CV_16UC1 : CV_8UC3, const_cast<void*>(frame.getData()),
                    static_cast<std::size_t>(frame.getStrideInBytes()));
  cv::Mat image;
  if (is_depth) {
    const bool fine = mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM;
    raw.convertTo(image, CV_32F, fine ? 0.1 : 1.0);
  } else {
    cv::cvtColor(raw, image, cv::COLOR_RGB2BGR);
  }
  return image;
}

/// An open camera. Its streams run.
class OpenniDevice final : public PictureCamera, openni::OpenNI::DeviceDisconnectedListener {
 public:
  OpenniDevice(const std::string& device, std::string name, double fps);
  ~OpenniDevice() override;

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }
  std::optional<LivePicture> read(Duration longest) override;

 private:
  void createStream(openni::VideoStream& stream, openni::SensorType sensor, const char* what);
  void setModes(double fps);
  void setOptions();
  void describe(double fps);
  void start(openni::VideoStream& stream, const char* what);
  // Thread: OpenNI2's.
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (uri_ == info->getUri()) gone_ = true;
  }

  std::string name_;
  OpenniLibrary library_;  // outlives device and streams
  openni::Device device_;
  openni::VideoStream color_;
  openni::VideoStream depth_;
  std::string uri_;
  OpenniModes modes_;
  SourceInfo info_;
  std::vector<std::string> warnings_;
  std::atomic<bool> gone_{false};
};

OpenniDevice::OpenniDevice(const std::string& device, std::string name, double fps)
    : name_(std::move(name)), library_(name_), uri_(findUri(device, name_)) {
  if (device_.open(uri_.c_str()) != openni::STATUS_OK)
    throw SourceError(
        name_ + ": cannot be opened" + describeOpenniError() +
        "; is it plugged in, used by another program, or access denied (udev rules)?");
  uri_ = device_.getDeviceInfo().getUri();
  createStream(color_, openni::SENSOR_COLOR, "colour");
  createStream(depth_, openni::SENSOR_DEPTH, "depth");
  setModes(fps);
  setOptions();
  describe(fps);
  start(color_, "colour");
  start(depth_, "depth");
  // Only now: OpenNI2 synchronises the streams that run. Without it PicturePairer alone decides.
  (void)device_.setDepthColorSyncEnabled(true);
  openni::OpenNI::addDeviceDisconnectedListener(this);
}

// The members' destructors stop the streams and close the device before OpenNI2 ends.
OpenniDevice::~OpenniDevice() { openni::OpenNI::removeDeviceDisconnectedListener(this); }

void OpenniDevice::createStream(openni::VideoStream& stream, openni::SensorType sensor,
                                const char* what) {
  if (device_.getSensorInfo(sensor) == nullptr)
    throw SourceError(name_ + ": has no " + what +
                      " stream; use a camera with both colour and depth");
  if (stream.create(device_, sensor) != openni::STATUS_OK)
    throw SourceError(name_ + ": its " + what + " stream cannot be opened" + describeOpenniError() +
                      "; is it used by another program?");
}

void OpenniDevice::setModes(double fps) {
  const auto colors = listModes(color_.getSensorInfo(), false);
  const auto depths = listModes(depth_.getSensorInfo(), true);
  if (colors.empty())
    throw SourceError(name_ + ": has no RGB colour of up to 1920x1080; use another camera");
  if (depths.empty())
    throw SourceError(name_ + ": has no depth in mm of up to 1920x1080; use another camera");
  const auto modes = selectModes(colors, depths, fps);
  if (!modes)
    throw SourceError(name_ + ": its depth has another shape than its colour (" +
                      sizeText(sizeOf(depths[0]).width, sizeOf(depths[0]).height) + " and " +
                      sizeText(sizeOf(colors[0]).width, sizeOf(colors[0]).height) +
                      "); use another camera");
  modes_ = *modes;
  if (color_.setVideoMode(modes_.color) != openni::STATUS_OK ||
      depth_.setVideoMode(modes_.depth) != openni::STATUS_OK)
    throw SourceError(name_ + ": refuses one of its own formats" + describeOpenniError());
}

void OpenniDevice::setOptions() {
  constexpr auto kRegistered = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  if (!device_.isImageRegistrationModeSupported(kRegistered) ||
      device_.setImageRegistrationMode(kRegistered) != openni::STATUS_OK)
    warnings_.push_back(name_ +
                        ": depth is not registered to colour, because the device cannot do that; "
                        "shapes and colours of edges are displaced");
  for (openni::VideoStream* stream : {&color_, &depth_}) {
    if (!stream->isPropertySupported(openni::STREAM_PROPERTY_MIRRORING)) continue;
    (void)stream->setMirroringEnabled(false);
    if (stream->getMirroringEnabled())
      warnings_.push_back(name_ + ": mirrors its pictures and cannot switch that off");
  }
}

void OpenniDevice::describe(double fps) {
  info_.name = name_;
  info_.width_px = modes_.color.getResolutionX();
  info_.height_px = modes_.color.getResolutionY();
  info_.fps = std::min(modes_.color.getFps(), modes_.depth.getFps());
  if (fps > 0.0 && fps != info_.fps)
    warnings_.push_back(name_ + ": has no rate of " + std::to_string(std::lround(fps)) +
                        " frames/s; it delivers " + std::to_string(std::lround(info_.fps)));
  if (!color_.isPropertySupported(openni::STREAM_PROPERTY_HORIZONTAL_FOV)) return;
  const double fov_deg = color_.getHorizontalFieldOfView() * 180.0 / std::numbers::pi;
  if (fov_deg >= 10.0 && fov_deg <= 170.0)
    info_.camera = CameraModel::ofFieldOfView(fov_deg, info_.width_px, info_.height_px);
}

void OpenniDevice::start(openni::VideoStream& stream, const char* what) {
  if (stream.start() != openni::STATUS_OK)
    throw SourceError(name_ + ": its " + what + " stream does not start" + describeOpenniError() +
                      "; is it used by another program?");
}

std::optional<LivePicture> OpenniDevice::read(Duration longest) {
  if (gone_) throw SourceError(name_ + ": was unplugged");
  std::array<openni::VideoStream*, 2> streams{&color_, &depth_};
  int ready = 0;
  const auto wait_ms = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
  if (openni::OpenNI::waitForAnyStream(streams.data(), 2, &ready, static_cast<int>(wait_ms)) !=
      openni::STATUS_OK)
    return std::nullopt;
  openni::VideoFrameRef frame;
  const bool is_depth = ready == 1;
  if (streams.at(is_depth ? 1 : 0)->readFrame(&frame) != openni::STATUS_OK || !frame.isValid())
    return std::nullopt;
  // By arrival: some drivers stamp their frames in other units than microseconds.
  LivePicture picture{is_depth, SteadyClock().now(), {}, ""};
  const openni::VideoMode& mode = is_depth ? modes_.depth : modes_.color;
  const std::string fault = findFault(frame, mode);
  if (fault.empty())
    picture.image = convertFrame(frame, mode);
  else
    picture.problem = name_ + ": " + fault;
  return picture;
}

}  // namespace

std::unique_ptr<RgbdSource> openOpenniCamera(const std::string& device, double fps) {
  const std::string name = device.empty() ? "openni" : "openni:" + device;
  return openPairedCamera([=] { return std::make_unique<OpenniDevice>(device, name, fps); });
}

}  // namespace hapticast::server

#else

namespace hapticast::server {

std::unique_ptr<RgbdSource> openOpenniCamera(const std::string& device, double /*fps*/) {
  throw SourceError("openni:" + device +
                    ": this build has no OpenNI2; install libopenni2-dev and build again");
}

}  // namespace hapticast::server

#endif
