// SPDX-License-Identifier: MIT
// A frame in pieces that fit datagrams: packed by who sends it, read one by one and joined by who
// gets it. Thread: any, one per object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/codec/coded_frame.hpp"
#include "common/codec/slice/covered_cells.hpp"
#include "common/result.hpp"
#include "common/transport/datagram.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// What one piece brings of an object.
struct ObjectPiece {
  CodedObject object;  ///< of its relief's slices and its grid's cells those that came
  bool head = false;   ///< motion, impacts, material and which relief it has came, too
  /// Of the grid, whose size is told whole and whose vectors begin here.
  std::size_t first_cell = 0;
};
struct FramePiece {
  std::vector<ObjectPiece> objects;
  /// Of the whole frame, where a head comes, or where there are none.
  std::optional<std::size_t> object_count = std::nullopt;
};

/// The payloads of a frame's datagrams, at most kMostPieceBytes each; none where it needs more than
/// kMostParts or 8 MiB. Requires a frame that decode() would take.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> packFrame(const CodedFrame& frame);

/// One payload by itself, with every number checked as decode() does it.
[[nodiscard]] Result<FramePiece, WireError> readPiece(std::span<const std::uint8_t> payload,
                                                      std::uint64_t frame);

/// A frame as its pieces come, in any order.
class Reassembly {
 public:
  /// The frame that this datagram is a part of; no probe.
  explicit Reassembly(const DatagramHeader& any_part);

  /// False where the part was had before or is none of this frame.
  [[nodiscard]] bool lacks(const DatagramHeader& part) const;
  /// Takes the payload of a part that it lacks. An error where it contradicts what came before:
  /// the frame is to be given up.
  [[nodiscard]] std::optional<WireError> add(const DatagramHeader& part,
                                             std::span<const std::uint8_t> payload);
  [[nodiscard]] bool whole() const { return had_count_ == header_.parts; }
  [[nodiscard]] const DatagramHeader& header() const { return header_; }
  /// Whether the head of every object has come: nothing of the frame is unknown but shapes.
  [[nodiscard]] bool headed() const;
  /// What has come of an object's relief; null where it has none, or its head is missing.
  [[nodiscard]] std::shared_ptr<const CodedRelief> relief(const ObjectKey& object);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< of what has come
  /// What has come so far: objects whose head has, with the slices that have; a grid only where all
  /// of it has.
  [[nodiscard]] CodedFrame frame() const;

 private:
  struct Joined {
    CodedObject object;
    CodedRelief relief;
    std::shared_ptr<const CodedRelief> in_order;  // the same, once it was asked for
    std::optional<codec::CoveredCells> covered;   // by its slices
    MotionGrid grid;
    std::vector<bool> cells;  // of the grid: those that came
    bool head = false;

    /// Whether grid and relief, as far as they are known, belong together.
    [[nodiscard]] bool covers() const;
  };
  [[nodiscard]] std::optional<WireError> addFragment(const ObjectPiece& piece);
  static bool addRelief(const CodedRelief& piece, bool head, Joined& to);
  static bool addGrid(const MotionGrid& piece, std::size_t first_cell, Joined& to);

  DatagramHeader header_;
  std::vector<bool> had_;
  std::size_t had_count_ = 0;
  std::size_t bytes_ = 0;
  std::size_t pixels_ = 0;  // of all reliefs' rectangles
  std::optional<std::size_t> object_count_;
  std::map<ObjectKey, Joined> objects_;
};

}  // namespace hapticast
