// SPDX-License-Identifier: MIT
// A driver for the real OpenNI2, without hardware. A file commands it: HAPTICAST_OPENNI_ORDERS
// names it, and the driver reads it again every 10 ms. What the driver is asked for stands in the
// same file with .calls behind its name. Two threads: one for each running stream. A third one
// watches the file.
//
// Orders, one `key value` a line, with their defaults (see Orders).
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include "tests/support/waiting.hpp"

namespace {

using oni::driver::DeviceBase;
using oni::driver::DriverBase;
using oni::driver::StreamBase;

constexpr const char* kUri = "hapticast/test@1";

std::string ordersFile() {
  const char* const file = std::getenv("HAPTICAST_OPENNI_ORDERS");
  return file == nullptr ? "" : file;
}

class Orders {
 public:
  Orders() {
    std::ifstream in(ordersFile());
    std::string key;
    int value = 0;
    while (in >> key >> value) values_[key] = value;
  }
  int operator[](const std::string& key) const { return values_.at(key); }

 private:
  std::map<std::string, int> values_{
      {"plugged", 1},
      {"opens", 1},  // the device
      {"color", 1},
      {"depth", 1},  // its streams
      {"color_width", 128},
      {"color_height", 96},
      {"depth_width", 128},
      {"depth_height", 96},
      {"color_format", ONI_PIXEL_FORMAT_RGB888},
      {"depth_format", ONI_PIXEL_FORMAT_DEPTH_1_MM},
      {"fps", 30},
      {"more_modes", 0},
      {"registration", 1},
      {"sync", 1},
      {"mirror", 1},
      {"fov_mrad", 1000},
      {"color_frames", 1},
      {"depth_frames", 1},
      {"lie_width", 0},
      {"lie_bytes", 0},
      {"lie_stride", 0},  // wrong frames, if not 0
  };
};

void note(const std::string& call) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::ofstream(ordersFile() + ".calls", std::ios::app) << call << "\n";
}

/// Depth of a near dome on a far wall, mm.
std::uint16_t depthAt(int x, int y, int width, int height) {
  const int dx = 4 * (2 * x - width), dy = 4 * (2 * y - height);
  const int r2 = dx * dx + dy * dy, limit = 4 * height * height;
  if (r2 >= limit) return 2000;
  return static_cast<std::uint16_t>(880 + 20 * std::int64_t{r2} / limit);
}

class Stream final : public StreamBase {
 public:
  Stream(OniSensorType sensor, std::vector<OniVideoMode> modes)
      : sensor_(sensor), modes_(std::move(modes)), mode_(modes_.at(0)) {}
  ~Stream() override { stop(); }

  OniStatus start() override {
    running_ = true;
    thread_ = std::thread([this] { run(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_MIRRORING ||
           id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return put(mode_, data, size);
    if (id == ONI_STREAM_PROPERTY_MIRRORING) return put(mirrored_, data, size);
    if (id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV)
      return put(static_cast<float>(Orders()["fov_mrad"]) / 1000.0F, data, size);
    return ONI_STATUS_NOT_IMPLEMENTED;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    const std::string name = sensor_ == ONI_SENSOR_DEPTH ? "depth" : "color";
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE && size == sizeof(mode_)) {
      std::memcpy(&mode_, data, sizeof(mode_));
      note(name + " mode " + std::to_string(mode_.resolutionX) + "x" +
           std::to_string(mode_.resolutionY));
      return ONI_STATUS_OK;
    }
    if (id == ONI_STREAM_PROPERTY_MIRRORING && size == sizeof(mirrored_)) {
      std::memcpy(&mirrored_, data, sizeof(mirrored_));
      note(name + " mirror " + std::to_string(mirrored_));
      return ONI_STATUS_OK;
    }
    return ONI_STATUS_NOT_IMPLEMENTED;
  }

 private:
  template <class Value>
  static OniStatus put(Value value, void* data, int* size) {
    if (*size != sizeof(value)) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(value));
    return ONI_STATUS_OK;
  }

  void run() {
    // Both streams have the same moments and numbers, as a synchronised camera has.
    using Clock = std::chrono::steady_clock;
    const auto interval = std::chrono::microseconds(1'000'000 / mode_.fps);
    while (running_) {
      const auto index = Clock::now().time_since_epoch() / interval + 1;
      std::this_thread::sleep_until(Clock::time_point(index * interval));
      const Orders orders;
      const bool wanted =
          orders[sensor_ == ONI_SENSOR_DEPTH ? "depth_frames" : "color_frames"] != 0;
      if (wanted && orders["plugged"] != 0) deliver(static_cast<int>(index), orders);
    }
  }

  void deliver(int index, const Orders& orders) {
    OniFrame* const frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    const int bytes = sensor_ == ONI_SENSOR_DEPTH ? 2 : 3;
    frame->frameIndex = index;
    frame->timestamp = static_cast<std::uint64_t>(index) * 33'333;
    frame->sensorType = sensor_;
    frame->videoMode = mode_;
    frame->width = mode_.resolutionX;
    frame->height = mode_.resolutionY;
    frame->stride = bytes * frame->width;
    frame->croppingEnabled = FALSE;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->dataSize = frame->stride * frame->height;
    draw(*frame);
    const auto lie = [&](const char* key, int& value) {
      if (orders[key] == 0) return;
      value = orders[key];
      note(key);
    };
    lie("lie_width", frame->width);
    lie("lie_bytes", frame->dataSize);
    lie("lie_stride", frame->stride);
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

  void draw(const OniFrame& frame) const {
    const int unit = mode_.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_100_UM ? 10 : 1;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const int from = mirrored_ != 0 ? frame.width - 1 - x : x;
        const std::uint16_t depth_mm = depthAt(from, y, frame.width, frame.height);
        if (sensor_ == ONI_SENSOR_DEPTH) {
          static_cast<std::uint16_t*>(frame.data)[y * frame.width + x] =
              static_cast<std::uint16_t>(unit * depth_mm);
        } else {
          auto* const pixel =
              static_cast<std::uint8_t*>(frame.data) + std::ptrdiff_t{3} * (y * frame.width + x);
          const bool wall = depth_mm == 2000;
          pixel[0] = wall ? (2 * from < frame.width ? 50 : 60) : 220;
          pixel[1] = wall ? 70 : 160;
          pixel[2] = wall ? 80 : 40;
        }
      }
    }
  }

  OniSensorType sensor_;
  std::vector<OniVideoMode> modes_;
  OniVideoMode mode_;
  OniBool mirrored_ = Orders()["mirror"];
  std::atomic<bool> running_{false};
  std::thread thread_;
};

class Device final : public DeviceBase {
 public:
  Device() {
    const Orders orders;
    if (orders["color"] != 0) addSensor(ONI_SENSOR_COLOR, "color", orders);
    if (orders["depth"] != 0) addSensor(ONI_SENSOR_DEPTH, "depth", orders);
    for (std::size_t i = 0; i < sensors_.size(); ++i)
      sensors_[i].pSupportedVideoModes = modes_[i].data();
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType type) override {
    for (std::size_t i = 0; i < sensors_.size(); ++i)
      if (sensors_[i].sensorType == type) return new Stream(type, modes_[i]);
    return nullptr;
  }
  void destroyStream(StreamBase* stream) override { delete stream; }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || Orders()["registration"] != 0;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(int))
      return ONI_STATUS_NOT_IMPLEMENTED;
    int mode = 0;
    std::memcpy(&mode, data, sizeof(mode));
    note("registration " + std::to_string(mode));
    return ONI_STATUS_OK;
  }

 private:
  void addSensor(OniSensorType type, const std::string& name, const Orders& orders) {
    const auto format = static_cast<OniPixelFormat>(orders[name + "_format"]);
    std::vector<OniVideoMode> modes{
        {format, orders[name + "_width"], orders[name + "_height"], orders["fps"]}};
    // Formats that a camera may offer and the server must not choose.
    if (orders["more_modes"] != 0) {
      modes.insert(modes.begin(), {{ONI_PIXEL_FORMAT_GRAY16, 128, 96, 30},
                                   {format, -5, 70000, 30},
                                   {format, 0, 0, 0},
                                   {format, 1280, 1024, 30}});
      modes.push_back({format, 64, 48, 30});
    }
    modes_.push_back(std::move(modes));
    sensors_.push_back({type, static_cast<int>(modes_.back().size()), nullptr});
  }

  std::vector<OniSensorInfo> sensors_;
  std::vector<std::vector<OniVideoMode>> modes_;
};

class Driver final : public DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {
    std::strcpy(info_.uri, kUri);
    std::strcpy(info_.vendor, "hapticast");
    std::strcpy(info_.name, "test");
  }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    (void)DriverBase::initialize(connected, disconnected, changed, cookie);
    plugged_ = Orders()["plugged"] != 0;
    if (plugged_) deviceConnected(&info_);
    watcher_ = std::thread([this] { watch(); });
    return ONI_STATUS_OK;
  }
  DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    if (std::strcmp(uri, kUri) == 0 && Orders()["opens"] != 0) return new Device();
    getServices().errorLoggerAppend("Access\nto %s denied", uri);
    return nullptr;
  }
  void deviceClose(DeviceBase* device) override { delete device; }
  void shutdown() override {
    ends_ = true;
    if (watcher_.joinable()) watcher_.join();
  }
  void* enableFrameSync(StreamBase** /*streams*/, int count) override {
    if (Orders()["sync"] == 0) return nullptr;
    note("sync " + std::to_string(count));
    return this;
  }

 private:
  void watch() {
    while (!ends_) {
      hapticast::restBetweenTurns(std::chrono::milliseconds(10));
      if (const bool now = Orders()["plugged"] != 0; now != plugged_) {
        plugged_ = now;
        if (now)
          deviceConnected(&info_);
        else
          deviceDisconnected(&info_);
      }
    }
  }

  OniDeviceInfo info_{};
  bool plugged_ = false;
  std::atomic<bool> ends_{false};
  std::thread watcher_;
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)
