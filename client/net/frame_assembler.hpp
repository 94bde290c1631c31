// SPDX-License-Identifier: MIT
// First stage of reception: reassembly and reordering. TCP delivers whole frames; datagrams deliver
// fragments of several frames in any order, some of them never. A fragmented frame leaves when it
// is complete or due, in the order of the ids. Times are arguments.
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

/// Position of a frame in the stream.
struct FramePlace {
  std::uint32_t epoch = 0;  ///< client-side epoch: unlike the server's, it never repeats
  bool first = false;       ///< first frame of its connection
  bool resync = false;      ///< numbering restarted: the id is no successor of the last one
  std::uint64_t lost = 0;  ///< number of missing frames before it; 0 for the first, and at a resync
  MediaTime media_time;
  Duration gap{0};  ///< media time since the frame before; 0 for the first, and at a resync
  /// Arrival of the last fragment; nullopt if fragments are missing.
  std::optional<LocalTime> arrived;
  LocalTime left{};  ///< time when the frame left the assembler
};

/// A frame and its position.
struct AssembledFrame {
  FramePlace place;
  CodedFrame frame;
};

/// A frame whose last fragment arrived after the frame had left or was abandoned.
struct LateFrame {
  MediaTime media_time;
  LocalTime arrived;
};

/// Reassembles and reorders the frames of a connection.
class FrameAssembler {
 public:
  /// Largest plausible step of the ids, in either direction: loss and reordering do not exceed it.
  /// Chosen: 10 s of the fastest stream.
  static constexpr std::uint64_t kLargestJump = 2400;
  /// Returns true if the distance of two ids is larger, in either order.
  [[nodiscard]] static constexpr bool jump(std::uint64_t a, std::uint64_t b) {
    return (a > b ? a - b : b - a) > kLargestJump;
  }
  /// Oldest fragment that is accepted, in frames. Chosen: redundant sends arrive at most three
  /// frames later, and a larger reordering is too late.
  static constexpr std::uint64_t kOldestPart = 64;
  /// Limits of the waiting fragmented frames: number, and bytes. The frames that have left have the
  /// same byte limit. Chosen.
  static constexpr std::size_t kMaxWaiting = 32;
  static constexpr std::size_t kMaxBytes = std::size_t{32} << 20U;

  /// Starts a connection: a new numbering and a new epoch.
  void restart();
  /// Client-side epoch of the next frame, unless the server starts a new epoch with it.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }
  /// Adds a frame that arrived over TCP. Returns false for a duplicate, and for a frame older than
  /// the last one. An id with a step above kLargestJump starts a new numbering and a new epoch.
  /// Older fragmented frames still leave first, when they are complete or due.
  bool add(CodedFrame frame, LocalTime arrived);

  /// Classes of a fragment, relative to the frames so far.
  enum class Want : std::uint8_t {
    kNew,     ///< missing
    kHad,     ///< duplicate
    kAstray,  ///< too far from the present frames, or its frame is finished
  };
  /// Classifies the fragment `part` without its payload.
  [[nodiscard]] Want setTransport(const DatagramHeader& part) const;
  /// Adds a fragment of the class kNew. Returns true if it completes its frame, even if the frame
  /// has already arrived over TCP. After an error the frame is abandoned.
  Result<bool, WireError> add(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                              LocalTime arrived);

  /// Media time of the last frame that left. The next frame is due when play time reaches it.
  [[nodiscard]] std::optional<MediaTime> lastLeft() const;
  /// Arrival of the last fragment of the oldest waiting frame; nullopt if none waits. A frame that
  /// next() withholds leaves at its due time only.
  [[nodiscard]] std::optional<LocalTime> oldestCame() const;
  /// Returns the next frame in order that may leave. `due`: waiting frames are due now.
  [[nodiscard]] std::optional<AssembledFrame> next(bool due);
  /// Returns a frame that was completed too late, once for each such frame.
  [[nodiscard]] std::optional<LateFrame> late();

 private:
  struct Waiting {
    std::optional<CodedFrame> frame;   // arrived over TCP
    std::optional<Reassembly> joined;  // arrived in fragments, perhaps in addition to TCP
    LocalTime arrived;                 // last arrival

    // Bytes of fragments.
    [[nodiscard]] std::size_t bytes() const { return joined ? joined->bytes() : 0; }
  };

  /// Clears everything except the last frame that left.
  void forget();
  /// True up to the id of the last frame that left.
  [[nodiscard]] bool behind(std::uint64_t id) const;
  /// Returns true if the id is neither a successor of the last one nor a straggler.
  [[nodiscard]] bool jumps(std::uint64_t id) const;
  [[nodiscard]] std::uint64_t newest() const;
  [[nodiscard]] bool overfull() const;
  /// Marks a frame as finished: it needs no more fragments.
  void abandon(std::uint64_t id);
  /// Drops the oldest frames of left_ above the limits.
  void boundLeft();
  [[nodiscard]] std::optional<AssembledFrame> removeReassembly(std::uint64_t id, Waiting waiting);
  AssembledFrame remove(CodedFrame frame, std::optional<LocalTime> arrived);
  /// Completes unchanged reliefs whose fragments arrived after their frame had left.
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
};

}  // namespace hapticast::client
