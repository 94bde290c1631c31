// SPDX-License-Identifier: MIT
#include "server/source/live/live_camera.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "server/source/picture/depth_scale.hpp"
#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

namespace {

constexpr Duration kDeviceSilence = std::chrono::seconds(1);  // without a frame: the device is gone
constexpr Duration kDeviceStart = std::chrono::seconds(5);    // chosen: cameras start in 1 to 3 s
constexpr Duration kPause = std::chrono::seconds(1);  // between two tries to open the device
constexpr Duration kLongestWait = std::chrono::milliseconds(50);  // of read()

LocalTime readSteadyClock() { return SteadyClock().now(); }

}  // namespace

PicturePairer::PicturePairer(double fps) : longest_apart_(fromSeconds(0.5 / fps)) {}

std::optional<LivePair> PicturePairer::push(LivePicture picture) {
  (picture.is_depth ? depth_ : color_) = std::move(picture);
  if (!color_ || !depth_ || std::chrono::abs(color_->time - depth_->time) > longest_apart_)
    return std::nullopt;
  LivePair pair{color_->image, depth_->image, color_->time};
  color_.reset();
  depth_.reset();
  return pair;
}

LiveCamera::LiveCamera(Open open) : open_(std::move(open)) {
  device_ = open_();
  info_ = device_->info();
  info_.live = true;
  for (const std::string& warning : device_->warnings()) spdlog::warn("{}", warning);
  pairer_.emplace(info_.fps);
  deadline_ = readSteadyClock() + kDeviceStart;
  while (!readPair()) {
  }
  began_ = readSteadyClock();
}

std::optional<RgbdFrame> LiveCamera::read() {
  try {
    if (!device_ && readSteadyClock() < next_try_) {
      std::this_thread::sleep_for(kLongestWait);
      return std::nullopt;
    }
    if (!device_) open();
    if (auto pair = readPair()) return makeFrame(std::move(*pair));
  } catch (const SourceError& error) {
    lose(error.what());
  }
  return std::nullopt;
}

void LiveCamera::rewind() { throw SourceError(info_.name + ": is live and cannot be rewound"); }

void LiveCamera::open() {
  device_ = open_();
  const SourceInfo& now = device_->info();
  if (now.width_px != info_.width_px || now.height_px != info_.height_px ||
      now.depth_kind != info_.depth_kind)
    throw SourceError(info_.name + ": delivers " + sizeText(now.width_px, now.height_px) +
                      ", but began with " + sizeText(info_.width_px, info_.height_px));
  pairer_.emplace(info_.fps);
  deadline_ = readSteadyClock() + kDeviceStart;
}

std::optional<LivePair> LiveCamera::readPair() {
  if (readSteadyClock() >= deadline_) throwNoPair();
  const LocalTime end = readSteadyClock() + kLongestWait;
  do {
    std::optional<LivePicture> picture = device_->read(kLongestWait);
    if (!picture) continue;
    (picture->is_depth ? any_depth_ : any_color_) = true;
    if (!picture->problem.empty()) {
      problem_ = picture->problem;
      skipped_.add(next_, problem_);
      skipped_.endRun();
    } else if (auto pair = pairer_->push(std::move(*picture))) {
      deadline_ = readSteadyClock() + kDeviceSilence;
      any_color_ = any_depth_ = false;
      problem_.clear();
      return pair;
    }
  } while (readSteadyClock() < end);
  return std::nullopt;
}

void LiveCamera::throwNoPair() const {
  if (!problem_.empty()) throw SourceError(problem_);
  const char* what = "colour and depth of one moment";
  if (!any_color_) what = any_depth_ ? "colour pictures" : "pictures";
  if (any_color_ && !any_depth_) what = "depth pictures";
  throw SourceError(info_.name + ": delivers no " + what + "; plug it in again");
}

RgbdFrame LiveCamera::makeFrame(LivePair pair) {
  const LocalTime now = readSteadyClock();
  if (away_) {
    spdlog::info("{}: frames are back", info_.name);
    away_ = false;
    ++epoch_;
    began_ = now;
  }
  if (pair.depth.size() != pair.color.size() && !std::exchange(logged_scaling_, true))
    logScaledDepth(info_.name, pair.depth.size(), pair.color.size());
  RgbdFrame frame;
  frame.index = next_++;
  frame.epoch = epoch_;
  frame.clip_time_s = toSeconds(now - began_);
  frame.color = std::move(pair.color);
  frame.depth = scaleDepth(pair.depth, info_.depth_kind, frame.color);
  frame.age = std::max(now - pair.time, Duration{});
  return frame;
}

void LiveCamera::lose(const std::string& reason) {
  device_.reset();
  if (!std::exchange(away_, true))
    spdlog::warn("{}; the server tries to open it again each second", reason);
  next_try_ = readSteadyClock() + kPause;
  any_color_ = any_depth_ = false;
  problem_.clear();
}

}  // namespace hapticast::server
