// SPDX-License-Identifier: MIT
// The first step of receiving: what the transports bring becomes frames in their order. TCP brings
// whole frames; datagrams bring parts of several frames in any order, some of them never. A frame
// of parts leaves when it is whole or due, whichever comes first, and never before an older one
// that may still come. Pure: times are arguments. Thread: network.
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

/// Where a frame stands in the stream.
struct FramePlace {
  std::uint32_t epoch = 0;  ///< client-side; unlike the server's it never repeats
  bool first = false;       ///< of its connection
  bool resync = false;      ///< its id is no successor of the last one's: numbering began anew
  std::uint64_t lost = 0;   ///< frames that are missing before it (0 for the first, and a resync)
  MediaTime media_time;
  Duration gap{0};  ///< media time since the frame before (0 for the first, and a resync)
  /// When the last of it came; nothing where parts of it are missing.
  std::optional<LocalTime> arrived;
  LocalTime left{};  ///< when it went on to be prepared
};

/// A frame in its place.
struct AssembledFrame {
  FramePlace place;
  CodedFrame frame;
};

/// A frame of which the last part came when it had left or been given up.
struct LateFrame {
  MediaTime media_time;
  LocalTime arrived;
};

class FrameAssembler {
 public:
  /// Chosen: 10 s of the fastest stream. Ids that jump further, forwards or backwards, are not
  /// those of a network that loses or reorders.
  static constexpr std::uint64_t kLargestJump = 2400;
  /// Whether two ids are so far apart, in either order.
  [[nodiscard]] static constexpr bool jump(std::uint64_t a, std::uint64_t b) {
    return (a > b ? a - b : b - a) > kLargestJump;
  }
  /// Chosen: copies come at most three frames later, and what is reordered by more is too late.
  static constexpr std::uint64_t kOldestPart = 64;
  /// Chosen: frames of parts that wait at a time, and their bytes; those of frames that have left
  /// may be as many.
  static constexpr std::size_t kMaxWaiting = 32;
  static constexpr std::size_t kMaxBytes = std::size_t{32} << 20U;

  /// A connection is made: ids start over, and a new epoch begins.
  void restart();
  /// The client-side epoch of the next frame, unless the server begins another one with it.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }
  /// Takes a frame as it came over TCP; false when it came before or when a later one did (ids
  /// rise). One whose id jumps by more than kLargestJump begins a numbering and an epoch of its
  /// own. Older frames of parts leave before it, when they are whole or due.
  bool add(CodedFrame frame, LocalTime arrived);

  /// What a datagram is to the frames so far.
  enum class Want : std::uint8_t {
    kNew,     ///< it is lacking
    kHad,     ///< it came before
    kAstray,  ///< too far from the frames that come, or the frame needs none
  };
  [[nodiscard]] Want setTransport(const DatagramHeader& part) const;
  /// Takes a part that is wanted; true where its frame is whole now, be it that TCP was quicker.
  /// After an error the frame is given up.
  Result<bool, WireError> add(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                              LocalTime arrived);

  /// The media time of the last frame that left: the next one is due when play time comes there.
  [[nodiscard]] std::optional<MediaTime> lastLeft() const;
  /// When the last part of the oldest frame that waits came; nothing where none waits. What next()
  /// does not give only its due time lets go.
  [[nodiscard]] std::optional<LocalTime> oldestCame() const;
  /// The next frame in order that may leave. `due`: the time has come for what waits.
  [[nodiscard]] std::optional<AssembledFrame> next(bool due);
  /// A frame that was completed too late, once for each.
  [[nodiscard]] std::optional<LateFrame> late();

 private:
  struct Waiting {
    std::optional<CodedFrame> frame;   // came over TCP
    std::optional<Reassembly> joined;  // in parts, or in parts as well
    LocalTime arrived;                 // the last that came of it

    [[nodiscard]] std::size_t bytes() const { return joined ? joined->bytes() : 0; }  // of parts
  };

  /// All but the last frame that left.
  void forget();
  [[nodiscard]] bool behind(std::uint64_t id) const;  ///< the last frame that left, or it
  /// Whether the id is no successor of the last one's, nor a straggler.
  [[nodiscard]] bool jumps(std::uint64_t id) const;
  [[nodiscard]] std::uint64_t newest() const;
  [[nodiscard]] bool overfull() const;
  /// Nothing more of this frame is wanted.
  void abandon(std::uint64_t id);
  /// Forgets the oldest of those that left where they are too many.
  void boundLeft();
  [[nodiscard]] std::optional<AssembledFrame> removeReassembly(std::uint64_t id, Waiting waiting);
  AssembledFrame remove(CodedFrame frame, std::optional<LocalTime> arrived);
  /// Reliefs that did not change and of which parts came after their frame had left.
  void fillUp(CodedFrame& frame);
  void forgetOld();
  Result<bool, WireError> addLate(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                                  LocalTime arrived);

  std::uint32_t epoch_ = 0;
  std::optional<std::uint32_t> server_epoch_;  // of the last frame of this connection that left
  std::optional<std::uint64_t> last_id_;       // the same
  MediaTime last_media_time_;                  // the same
  std::map<std::uint64_t, Waiting> waiting_;   // by id
  // Of the last kOldestPart frames: those that left or were passed over before they were whole, and
  // those of which nothing more is wanted. Both are bounded whatever the ids are.
  std::map<std::uint64_t, Reassembly> left_;  // by id
  std::set<std::uint64_t> done_;
  std::set<std::uint64_t> by_tcp_;  // frames that left whole; parts only show that they get through
  std::deque<LateFrame> late_;
};

}  // namespace hapticast::client
