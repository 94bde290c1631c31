// SPDX-License-Identifier: MIT
// First stage of reception: joins the fragments of frames and puts the frames in order. TCP
// delivers whole frames. Datagrams deliver fragments of several frames in any order, and some never
// arrive. The assembler passes a fragmented frame on when it is complete, or when it is due for
// play. It passes frames on in the order of their ids. A frame that it has passed on has *left*.
// Times are arguments.
// Thread: network.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/fragment.hpp"
#include "common/time.hpp"
#include "common/transport/datagram.hpp"

namespace hapticast::client {

/// Position of a frame in the stream, and the times of its reception.
struct FramePlace {
  std::uint32_t epoch = 0;  ///< client-side epoch; unlike the server's epoch it never repeats
  bool first = false;       ///< first frame of its connection
  /// The server restarted its numbering, so the id does not follow the last one.
  bool resync = false;
  /// Number of missing frames before it; 0 for the first frame and after a restart.
  std::uint64_t lost = 0;
  MediaTime media_time;
  /// Media time since the frame before; 0 for the first frame and after a restart.
  Duration gap{0};
  /// Time when the last fragment arrived. nullopt if fragments are missing.
  std::optional<LocalTime> arrived;
  /// Time when the frame left the assembler, plus the pauses that FrameQueue::holdBack() adds.
  LocalTime left{};
};

/// A frame and its position in the stream.
struct AssembledFrame {
  FramePlace place;
  CodedFrame frame;
};

/// A frame whose last fragment arrived too late: the frame had already left, or the assembler had
/// dropped it.
struct LateFrame {
  MediaTime media_time;
  LocalTime arrived;
};

/// Joins and orders frames. One object serves all connections, so that client-side epochs never
/// repeat: restart() begins the next connection.
class FrameAssembler {
 public:
  /// Largest step of the ids, up or down, that loss or reordering can explain. The value is a
  /// choice: 10 s of the fastest stream.
  static constexpr std::uint64_t kLargestJump = 2400;
  /// Returns true if the distance of two ids, in either order, is larger than kLargestJump.
  [[nodiscard]] static constexpr bool jump(std::uint64_t a, std::uint64_t b) {
    return (a > b ? a - b : b - a) > kLargestJump;
  }
  /// Age, in frames, of the oldest accepted fragment. The value is a choice: repeated sends arrive
  /// at most three frames later, and a fragment that is much older is too late for play.
  static constexpr std::uint64_t kOldestPart = 64;
  /// Limits for the frames that wait for fragments: their number and their bytes. The same limit of
  /// bytes holds for the frames that left incomplete. The values are a choice.
  static constexpr std::size_t kMaxWaiting = 32;
  static constexpr std::size_t kMaxBytes = std::size_t{32} << 20U;

  /// Number of the last frames that left whose content is stored, to detect a second version that
  /// differs. The value is a choice: a second version of an older frame has no effect.
  static constexpr std::size_t kMaxCompared = 8;

  /// Starts a connection, with a new numbering and a new epoch.
  void restart();
  /// Continues the client-side epochs after `last`. Call it before the first restart().
  void continueEpochs(std::uint32_t last) { epoch_ = last; }
  /// Returns true if two different versions of one frame arrived in this connection. A server that
  /// signs both contradicts itself, so the client can use neither. No more frames leave until
  /// restart().
  [[nodiscard]] bool contradicted() const { return contradicted_; }
  /// Returns the present client-side epoch. If the next frame continues the server's epoch, its
  /// client-side epoch has this value. If it begins a new epoch of the server, its client-side
  /// epoch is one higher.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }
  /// Adds a whole frame that arrived over TCP and returns true. If the frame is a duplicate or
  /// older than the last frame that left, drops it and returns false. If the step of the id exceeds
  /// kLargestJump, a new numbering and a new epoch begin. The assembler then drops all waiting
  /// frames.
  bool add(CodedFrame frame, LocalTime arrived);

  /// Classes of a fragment, by the frames that arrived so far.
  enum class Want : std::uint8_t {
    kNew,     ///< the fragment is missing, so it is needed
    kHad,     ///< the fragment is a duplicate, or its frame is finished
    kAstray,  ///< its frame is too far from the present frames
  };
  /// Returns the class of the fragment with the header `part`. The payload is not needed.
  [[nodiscard]] Want classify(const DatagramHeader& part) const;
  /// Adds a fragment of the class kNew. Returns true if the fragment completes its frame, even if
  /// the same frame has already arrived over TCP. If the fragment contradicts the earlier ones,
  /// returns an error and drops the fragments of the frame.
  Result<bool, WireError> add(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                              LocalTime arrived);

  /// Returns the media time of the last frame that left. The next frame is due when play time
  /// reaches that time.
  [[nodiscard]] std::optional<MediaTime> findLastLeft() const;
  /// Returns the arrival time of the oldest waiting frame, or of its newest fragment if fragments
  /// are missing. Returns nullopt if no frame waits.
  [[nodiscard]] std::optional<LocalTime> oldestCame() const;
  /// Returns the next frame in order that may leave, or nullopt if none may leave. If `due` is
  /// true, waiting frames are due now, so they may leave incomplete.
  [[nodiscard]] std::optional<AssembledFrame> next(bool due);
  /// Returns a frame whose last fragment arrived too late. Returns each such frame once, and
  /// nullopt if there is none.
  [[nodiscard]] std::optional<LateFrame> takeLate();

 private:
  struct Waiting {
    std::optional<CodedFrame> frame;   // arrived over TCP
    std::optional<Reassembly> joined;  // arrived in fragments, perhaps in addition to TCP
    LocalTime arrived;                 // last arrival

    // Bytes of fragments.
    [[nodiscard]] std::size_t bytes() const { return joined ? joined->bytes() : 0; }
  };

  /// Compares a version of a frame with the versions that arrived by the other transport or
  /// earlier. Returns true if they differ, and drops all frames.
  bool contradicts(const CodedFrame& frame, const Reassembly* joined);
  /// Drops all incomplete frames. Keeps the id and epoch of the last frame that was passed on.
  void forget();
  /// Returns true if `id` is at most the id of the last frame that left.
  [[nodiscard]] bool behind(std::uint64_t id) const;
  /// Returns true if no loss or reordering can explain the step from the last id to `id`.
  [[nodiscard]] bool jumps(std::uint64_t id) const;
  [[nodiscard]] std::uint64_t newest() const;
  [[nodiscard]] bool isOverfull() const;
  /// Drops the frames by datagrams that are older than the first frame by TCP, which has all
  /// reliefs. Call it before the first frame left.
  void dropBeforeTcp();
  /// Returns true if a frame by datagrams follows the last one that left. The first frame of a
  /// connection must have all reliefs, because the server sent its unchanged reliefs before the
  /// connection.
  [[nodiscard]] bool follows(const Reassembly& joined) const;
  /// Marks a frame as finished: it needs no more fragments.
  void abandon(std::uint64_t id);
  /// Drops the oldest frames of left_ above the limits.
  void boundLeft();
  [[nodiscard]] std::optional<AssembledFrame> removeReassembly(std::uint64_t id, Waiting waiting);
  AssembledFrame remove(CodedFrame frame, std::optional<LocalTime> arrived);
  /// Completes reliefs that `frame` declares unchanged, with fragments that arrived after their own
  /// frame had left.
  void fillUp(CodedFrame& frame);
  void forgetOld();
  Result<bool, WireError> addLate(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                                  LocalTime arrived);

  std::uint32_t epoch_ = 0;
  std::optional<std::uint32_t> server_epoch_;  // of the last frame of this connection that left
  std::optional<std::uint64_t> last_id_;       // of the same frame
  MediaTime last_media_time_;                  // of the same frame
  std::map<std::uint64_t, Waiting> waiting_;   // by id
  // Within the last kOldestPart frames: left_ has the frames that left or were skipped before they
  // were complete, done_ the finished ones. Both are bounded, whatever the ids are.
  std::map<std::uint64_t, Reassembly> left_;  // by id
  std::set<std::uint64_t> done_;
  std::set<std::uint64_t> by_tcp_;  // left over TCP; their fragments only show that UDP works
  std::deque<LateFrame> late_;
  std::map<std::uint64_t, CodedFrame> compared_;  // by id: the last frames that left
  bool contradicted_ = false;
};

}  // namespace hapticast::client
