// SPDX-License-Identifier: MIT
// Fragmentation and reassembly: the sender splits a frame into payloads that fit datagrams; the
// receiver checks each one and joins them in any order. Thread: any, one for each object.
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

/// Part of an object in one fragment.
struct ObjectPiece {
  CodedObject object;  ///< with only this fragment's slices and cells
  bool head = false;   ///< includes motion, impacts, material and the relief's rectangle
  /// First cell of the grid's vectors in this fragment; columns and rows describe the whole grid.
  std::size_t first_cell = 0;
};
/// Content of one fragment.
struct FramePiece {
  std::vector<ObjectPiece> objects;
  /// Number of objects of the whole frame, if the fragment has a head or no objects.
  std::optional<std::size_t> object_count = std::nullopt;
};

/// Splits `frame` into payloads of at most kMostPieceBytes. Returns none if it needs more than
/// kMostParts or 8 MiB. Requires a frame that decode() would accept.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> packFrame(const CodedFrame& frame);

/// Reads one payload, with the checks of decode(). `frame`: id of its frame.
[[nodiscard]] Result<FramePiece, WireError> readPiece(std::span<const std::uint8_t> payload,
                                                      std::uint64_t frame);

/// Reassembles a frame from its fragments, in any order.
class Reassembly {
 public:
  /// Starts the frame of this datagram. Requires a header that is no probe.
  explicit Reassembly(const DatagramHeader& any_part);

  /// Returns whether the part belongs to this frame and is still missing.
  [[nodiscard]] bool lacks(const DatagramHeader& part) const;
  /// Adds the payload of a missing part. Returns an error if it contradicts earlier parts; then the
  /// frame must be discarded.
  [[nodiscard]] std::optional<WireError> add(const DatagramHeader& part,
                                             std::span<const std::uint8_t> payload);
  /// Returns whether all parts are present.
  [[nodiscard]] bool whole() const { return had_count_ == header_.parts; }
  [[nodiscard]] const DatagramHeader& header() const { return header_; }
  /// Returns whether the heads of all objects are present, so that only slices and cells may be
  /// missing.
  [[nodiscard]] bool headed() const;
  /// Returns the received part of an object's relief; null if it has no relief or its head is
  /// missing.
  [[nodiscard]] std::shared_ptr<const CodedRelief> relief(const ObjectKey& object);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< bytes received
  /// Returns the received part of the frame: objects with a head, with their slices so far. Only
  /// complete grids.
  [[nodiscard]] CodedFrame frame() const;

 private:
  struct Joined {
    CodedObject object;
    CodedRelief relief;
    std::shared_ptr<const CodedRelief> in_order;  // cached result of relief()
    std::optional<codec::CoveredCells> covered;   // by its slices
    MotionGrid grid;
    std::vector<bool> cells;  // received cells of the grid
    bool head = false;

    /// Returns whether grid and relief, as far as received, belong together.
    [[nodiscard]] bool covers() const;
  };
  [[nodiscard]] std::optional<WireError> addFragment(const ObjectPiece& piece);
  static bool addRelief(const CodedRelief& piece, bool head, Joined& to);
  static bool addGrid(const MotionGrid& piece, std::size_t first_cell, Joined& to);

  DatagramHeader header_;
  std::vector<bool> had_;
  std::size_t had_count_ = 0;
  std::size_t bytes_ = 0;
  std::size_t pixels_ = 0;  // sum of all reliefs' rectangles
  std::optional<std::size_t> object_count_;
  std::map<ObjectKey, Joined> objects_;
};

}  // namespace hapticast
