// SPDX-License-Identifier: MIT
// Source from video, in one of three forms. A pair has two files, whose frames are paired by time,
// or by number if there are no times (frame_times.hpp). A file or stream with two tracks has frames
// that are paired by time. A file or stream with one track has colour and depth in the halves of
// its pictures. 8-bit depth is height (near is white). Depth with more bits is in mm. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "server/source/picture/image_file.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/scale/depth_registration.hpp"
#include "server/source/skipped_frames.hpp"
#include "server/source/video/frame_times.hpp"
#include "server/source/video/video_file.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// A track of an open file. Two channels may share a file.
struct VideoChannel {
  std::shared_ptr<VideoFile> file;
  std::size_t track = 0;
  double start_s = 0.0;  ///< time on the clock of the file that counts as 0

  /// Returns the time of the frame, s; negative infinity if there is none.
  [[nodiscard]] double time_s() const { return file->time_s(track) - start_s; }
  [[nodiscard]] const VideoTrack& facts() const { return file->tracks()[track]; }
};

/// Source whose frames are those of one or two files, or of one stream. It skips damaged frames.
class VideoClip final : public RgbdSource {
 public:
  /// Opens a pair of files and decodes their first frames. `fps` > 0 overrides the colour video's
  /// rate, frames/s. If both files state times (belongByTime()), each colour frame has the depth
  /// frame that is nearest in time, counted from the first frame of each file. RgbdFrame::index is
  /// then the time at the nominal rate of the colour, so it has gaps where frames are missing. One
  /// warning for each file counts the frames without a partner. Otherwise frames belong together by
  /// number. The clip ends with the shorter file. Throws SourceError if the files' aspect ratios
  /// differ, or if their lengths differ by more than five frames. It also throws if both are one
  /// file, or if the depth is in false colours and the code of `layout` is not kHue.
  VideoClip(const std::string& color_file, const std::string& depth_file, double fps,
            const VideoLayout& layout = {});
  /// Decodes the first frame of `video`, of which no track may have started. `fps`: as above. With
  /// Layout::kSeparate the depth track is an Azure Kinect's depth track, else the track with the
  /// word depth in its title, else the only grey track. Each colour frame has the depth frame that
  /// is nearest in time. With VideoLayout::color_only there is no depth. Throws SourceError. If
  /// there is one track and no layout, the error message has the likely layout. A stream cannot be
  /// rewound, so its source begins with the second frame, and RgbdFrame::clip_time_s is the
  /// stream's own time.
  VideoClip(std::unique_ptr<VideoFile> video, const VideoLayout& layout, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame. Throws SourceError if no frame of the whole clip is readable, for
  /// example because the files were deleted or changed.
  std::optional<RgbdFrame> read() override;
  bool skip() override { return grab(); }
  void rewind() override;

 private:
  [[nodiscard]] bool isPair() const { return color_.file != depth_.file; }
  [[nodiscard]] bool hasHalves() const { return layout_.layout != Layout::kSeparate; }
  /// Returns whether the depth comes from a track of its own.
  [[nodiscard]] bool hasDepthTrack() const { return !hasHalves() && !layout_.color_only; }
  /// Decodes the first frame and describes the source. Then rewinds to that frame, if possible.
  void begin(double fps);
  /// Sets the sizes and the kind of depth from the first frame, and logs if depth is scaled. Throws
  /// SourceError if the pictures cannot be a source.
  void describe(const cv::Mat& color, const cv::Mat& raw, double fps);
  /// Sets the name, the size and the rate.
  void describeColor(const cv::Mat& color, double fps);
  /// Chooses the tracks of a single file. Throws SourceError if they are not clear.
  void chooseTracks();
  /// Throws the SourceError for a file with a single track; its message has the likely layout.
  [[noreturn]] void throwOneTrack();
  /// Throws SourceError if the pictures are too large.
  void requireSizes() const;
  /// Prepares the registration of a Kinect's depth from its attached calibration. Logs a warning if
  /// that is impossible. Throws SourceError if the calibration is damaged.
  void prepareRegistration();
  /// Reads the times of both files of a pair. Sets `by_time_` if they decide which frames belong
  /// together. Logs a warning if numbers decide although times are missing in one of the files.
  void choosePairing();
  /// Logs a warning for each file of a pair that has frames without a partner at their time: their
  /// number and the time of the first one. Throws SourceError if the durations of the files differ
  /// by more than five frames. Requires `by_time_`.
  void checkTimes() const;
  /// Returns the nominal rate of the colour, frames/s.
  [[nodiscard]] double nominalRate() const;
  /// Logs a warning if the files of a pair state different frame rates.
  void warnOfOtherRate() const;
  /// Returns the number of frames, of a pair that of the shorter file; nullopt if it is not stated.
  /// Throws SourceError if the numbers of a pair differ by more than five.
  [[nodiscard]] std::optional<std::uint64_t> countFrames() const;
  void startTracks();

  /// Moves to the next frame and counts it. Returns false at the end.
  bool grab();
  /// Moves both channels to the next frame, whose number is `next_` or larger. Returns false at the
  /// end.
  /// Throws SourceError if there is no first frame.
  bool grabFrame();
  bool grabByNumber();
  bool grabByTime();
  /// Moves the depth to the frame of the colour's time. Returns false at the end of the depth.
  bool followColor();
  /// Moves the depth to its first frame from `least_s` on. Returns false at the end of the depth.
  bool grabDepthFrom(double least_s);
  /// Throws the SourceError of a file without a first frame.
  [[noreturn]] void throwNoFrame(const VideoChannel& channel) const;
  /// Logs once that one channel ends before the other.
  void logCut(const std::string& text);
  /// Sets the pictures of the frame: colour as CV_8UC3, and depth as the file has it, or registered
  /// as CV_32FC1 in mm. A picture is empty if it is damaged. Returns "", or another problem of the
  /// frame, as a phrase.
  std::string retrieve(cv::Mat& color, cv::Mat& depth);
  /// Sets pictures of `frame`. Returns the problem with the file's name, or "".
  std::string load(RgbdFrame& frame);
  /// Returns the problem of one picture of frame `index` with the file's name.
  static std::string describeProblem(const VideoChannel& channel, std::uint64_t index,
                                     const std::string& problem);

  /// Times of the files of a pair whose frames belong together by time.
  struct PairTimes {
    FrameTimes color;
    FrameTimes depth;
  };

  VideoLayout layout_;
  std::optional<PairTimes> by_time_;
  VideoChannel color_;
  VideoChannel depth_;
  SourceInfo info_;
  DepthFormat format_;
  cv::Size color_size_;  // sizes of the pictures in the files
  cv::Size depth_size_;
  std::optional<DepthRegistration> registration_;                   // nullopt: aligned already
  std::optional<CameraModel> camera_;                               // of the colour, if known
  double color_time_s_ = -std::numeric_limits<double>::infinity();  // latest so far
  bool depth_grabbed_ = false;  // whether the depth has a frame, of a pairing by time
  bool depth_damaged_ = false;  // whether damaged depth was passed on the way to that frame
  std::string problem_;         // problem of the frame's time; "" if depth belongs to colour
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool ended_ = false;
  bool any_read_ = false;      // whether a frame was read since the clip's start
  bool cut_reported_ = false;  // whether a warning of a clip that ends early was logged
  SkippedFrames skipped_;
};

}  // namespace hapticast::server
