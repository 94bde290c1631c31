// SPDX-License-Identifier: MIT
// Source that adds the answers of the user's program to the frames of another source. One child
// runs for all frames. A few frames are in flight at a time, so the child works while vision does.
// A frame of a recorded clip waits for its answer. A live source waits only as long as its task
// allows. A child that ends, hangs or writes something else is started again: a gap with one line
// of the log. Thread: one, beside the thread of ChildPipe.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "server/source/child/child_pipe.hpp"
#include "server/source/child/child_settings.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/skipped_frames.hpp"

namespace hapticast::server {

/// Longest side of a picture in an answer, px. Chosen: twice the largest frame.
inline constexpr int kMostAnswerSide_px = 4096;

/// What a child does for each frame. There is one implementation for depth and one for masks.
/// Thread: that of the source, but measure(): that of ChildPipe.
class ChildTask {
 public:
  virtual ~ChildTask() = default;
  /// Returns the name of the flag, for messages.
  [[nodiscard]] virtual const char* flag() const = 0;
  [[nodiscard]] virtual const std::string& command() const = 0;
  /// Returns whether a frame without an answer is unusable.
  [[nodiscard]] virtual bool isRequired() const = 0;
  /// Adds to `frame` the stored answer for it, of this run or of an earlier one. Returns false if
  /// there is none.
  virtual bool recall(RgbdFrame& frame) = 0;
  /// Returns the bytes that ask for the answer of `frame`.
  [[nodiscard]] virtual std::vector<std::uint8_t> ask(const RgbdFrame& frame) = 0;
  /// As ChildPipe::MeasureAnswer.
  [[nodiscard]] virtual std::optional<std::size_t> measure(const std::string& header) const = 0;
  /// Adds the answer to `frame`. Returns its problem as a phrase, or "".
  virtual std::string apply(RgbdFrame& frame, const ChildAnswer& answer) = 0;
  /// Returns the advice for a clip that plays again; "" if there is none.
  [[nodiscard]] virtual const char* advise() const { return ""; }
  /// Sets what the frames have now. Called once, after the first answer.
  virtual void describe(SourceInfo& info) const = 0;
};

/// The frames of a source with the answers of a child.
class ChildSource final : public RgbdSource {
 public:
  /// Waits for the answer of the first frame. `keep_waiting` may be null. Throws SourceError if the
  /// child cannot answer.
  ChildSource(std::unique_ptr<RgbdSource> source, std::unique_ptr<ChildTask> task,
              KeepWaiting keep_waiting);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// As RgbdSource::read(). Throws SourceError also if the child of a recorded clip ends three
  /// times without an answer that the frames require.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// A frame on its way through the child.
  struct Pending {
    RgbdFrame frame;
    LocalTime since;  ///< when the source delivered it
    bool ready = false;
    bool loads = false;        ///< a live child received it before its first answer
    std::string problem = {};  ///< of a ready frame that is unusable
  };
  using Waiting = std::shared_ptr<Pending>;

  /// Waits for the answer of the first frame. Throws SourceError.
  void waitForFirst();
  /// Returns whether another frame may be in flight.
  bool hasRoom();
  /// Returns the oldest frame if it is ready. Drops unusable frames before it.
  std::optional<RgbdFrame> popReady();
  std::optional<RgbdFrame> readRecorded();
  std::optional<RgbdFrame> readLive();
  /// Reads the next frame of the source and asks for its answer. Returns false if there is none.
  bool askNext();
  /// Starts a child if the pause is over and a frame waits. Sends it all frames that wait.
  void startChild();
  /// Sends a frame to the child. Requires one.
  void send(const Waiting& waiting);
  /// Sends the last picture again, so that a child that answers late answers the frames before it.
  void sendLastAgain();
  /// Receives answers. Waits for the first one, at most `longest`. Then restarts a child that has
  /// failed or hangs.
  void receive(Duration longest);
  void addAnswer(const ChildAnswer& answer);
  /// Ends a child that cannot answer any more. Throws SourceError after the third time of a
  /// recorded clip.
  void restart(const std::string& problem);
  /// Lets frames pass whose answer is late and not required.
  void passLate();
  [[nodiscard]] bool keepsWaiting() const { return !keep_waiting_ || keep_waiting_(); }
  void logGap();
  /// Logs that answers are missing, once in a gap.
  void beginGap(const std::string& line);
  [[nodiscard]] std::string name() const;

  /// kOpening: no frame has its answer yet. kGivenUp: no child starts any more.
  enum class Phase : std::uint8_t { kOpening, kServing, kGivenUp };
  /// A time without answers.
  struct Gap {
    bool is_logged = false;
    bool begins_epoch = false;  ///< whether the next answer of a live source begins an epoch
    LocalTime begin{};
  };
  /// Messages that are in the log already; each is logged once.
  struct Logged {
    bool advice = false;   ///< ChildTask::advise(), when the clip plays again
    bool wait = false;     ///< the source waits for the first answer
    bool problem = false;  ///< the problem of an answer that is not required
  };

  const SteadyClock clock_;
  std::unique_ptr<RgbdSource> source_;
  std::unique_ptr<ChildTask> task_;
  KeepWaiting keep_waiting_;
  SourceInfo info_;
  std::unique_ptr<ChildPipe> pipe_;  // null: no child runs
  std::deque<Waiting> pending_;      // frames that read() has not returned, oldest first
  std::deque<Waiting> asked_;        // frames without an answer, oldest first; null: sent again
  std::vector<std::uint8_t> last_request_;
  LocalTime last_sign_{};    // when the child answered last, or received a picture while idle
  LocalTime restart_at_{};   // when the next child may start
  int failures_ = 0;         // since a child has answered a while
  std::size_t answers_ = 0;  // of this child
  Duration usual_{};         // usual time between answers
  Phase phase_ = Phase::kOpening;
  Gap gap_;
  Logged logged_;
  std::size_t most_live_ = 2;       // frames of a live source in flight; more would be a delay
  bool ended_ = false;              // whether the source has ended
  std::uint64_t frames_read_ = 0;   // since the start of the clip
  bool wants_child_ = false;        // whether a child starts even if no frame waits
  int late_ = 0;                    // answers of a live source in a row that came too late
  std::uint32_t source_epoch_ = 0;  // of the last frame
  std::size_t lag_ = 0;             // pictures behind a frame that the child needs for its answer
  std::size_t sent_again_ = 0;      // at this end of the clip
  std::uint32_t gaps_ = 0;          // of a live source: each begins an epoch
  double epoch_begin_s_ = 0;        // of a live source: clip time at which the epoch began
  SkippedFrames skipped_;
};

}  // namespace hapticast::server
