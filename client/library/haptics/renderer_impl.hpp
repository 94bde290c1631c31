// SPDX-License-Identifier: MIT
// Inside of hapticast::Renderer (hapticast/renderer.hpp). A feed carries frames to a renderer. It
// belongs to push(), to a Stream or to a MessagePlayer, which writes to it.
// Thread: the loop's, except where a function states another one.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "client/haptics/renderer.hpp"
#include "client/include/hapticast/renderer.hpp"
#include "common/library/frame_import.hpp"

namespace hapticast {

/// The connection between the producer of frames and the loop.
struct FrameFeed {
  client::FramePool pool;
  LatestValue<client::StreamTiming> timing;
};

/// Producer of the frames that the caller pushes. Thread: that of Renderer::push().
class PushFeed {
 public:
  PushFeed(std::shared_ptr<FrameFeed> feed, bool thesis, double delay_s)
      : feed_(std::move(feed)), thesis_(thesis), delay_s_(delay_s) {}
  void begin(const StreamInfo& info);
  bool push(const Frame& frame);

 private:
  /// Returns the prepared relief of `object`, which the frame before may have had already.
  [[nodiscard]] std::shared_ptr<const HeightField> prepare(const HapticObject& object);

  struct Prepared {
    std::shared_ptr<const Relief> relief;
    std::shared_ptr<const HeightField> field;
  };
  std::shared_ptr<FrameFeed> feed_;
  bool thesis_;
  double delay_s_;
  std::optional<FrameImporter> importer_;
  std::map<ObjectKey, Prepared> prepared_;  // of the frame before
  std::uint64_t last_id_ = 0;
  std::uint32_t epoch_ = 0;  // client-side
  std::optional<std::uint32_t> frame_epoch_;
  std::optional<double> last_time_s_;
};

class Renderer::Impl {
 public:
  explicit Impl(const RendererSettings& settings);

  /// Makes the renderer play the frames of `feed`. Throws std::invalid_argument if it has had ticks
  /// or frames.
  void attach(std::shared_ptr<FrameFeed> feed);
  /// Throws std::invalid_argument if the renderer plays another feed.
  [[nodiscard]] PushFeed& pushFeed();
  [[nodiscard]] Method method() const { return settings_.method; }

  const Tick& tick(double time_s, const Eigen::Vector3d& position_mm, std::uint32_t buttons);
  void setControls(const Controls& controls);
  [[nodiscard]] DeviceMapping mapping();

 private:
  void exportReport(const client::TickReport& report, double time_s);

  const client::RendererSettings settings_;  // the renderer refers to it
  const double delay_s_;
  std::shared_ptr<FrameFeed> feed_ = std::make_shared<FrameFeed>();
  LatestValue<client::UserControls> user_;
  std::optional<client::HapticRenderer> renderer_;  // refers to the four members above
  std::optional<PushFeed> push_feed_;
  bool attached_ = false;
  LocalTime last_{LocalTime::min()};
  Tick tick_;
};

}  // namespace hapticast
