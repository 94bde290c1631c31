// SPDX-License-Identifier: MIT
// Fragmentation and reassembly of frames. The sender splits a frame into fragments that fit
// datagrams. The receiver checks each fragment and joins the fragments in any order. Thread: any;
// at most one at a time for each object.
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

/// The part of one object that a fragment carries.
struct ObjectPiece {
  CodedObject object;  ///< the object, but only with the slices and grid cells of this fragment
  /// True: `object` has motion, impacts, material and the rectangle of the relief.
  bool head = false;
  /// Index of the first grid cell in this fragment. `columns` and `rows` of the grid are those of
  /// the whole grid.
  std::size_t first_cell = 0;
};
/// Content of one fragment.
struct FramePiece {
  std::vector<ObjectPiece> objects;
  /// Number of objects of the whole frame. It is present if `objects` is empty, or if it has an
  /// ObjectPiece with `head`.
  std::optional<std::size_t> object_count = std::nullopt;
};

/// Returns the fragments of `frame`, each of at most kMostPieceBytes. Returns none if the frame
/// needs more than kMostParts fragments or 8 MiB. Requires a frame that decode() would accept.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> packFrame(const CodedFrame& frame);

/// Decodes one fragment, with the same checks as decode(). `frame` is the id of its frame.
[[nodiscard]] Result<FramePiece, WireError> readPiece(std::span<const std::uint8_t> payload,
                                                      std::uint64_t frame);

/// Joins the fragments of one frame, which may arrive in any order.
class Reassembly {
 public:
  /// Starts the frame to which `any_part` belongs. Requires the header of a fragment, not of a
  /// probe.
  explicit Reassembly(const DatagramHeader& any_part);

  /// Returns true if the fragment with the header `part` belongs to this frame and is still
  /// missing.
  [[nodiscard]] bool lacks(const DatagramHeader& part) const;
  /// Adds the payload of a missing fragment. Returns an error if it contradicts earlier fragments.
  /// The caller must then drop the whole frame.
  [[nodiscard]] std::optional<WireError> add(const DatagramHeader& part,
                                             std::span<const std::uint8_t> payload);
  /// Returns true if all fragments are present.
  [[nodiscard]] bool whole() const { return had_count_ == header_.parts; }
  [[nodiscard]] const DatagramHeader& header() const { return header_; }
  /// Returns true if the heads of all objects are present. Then only slices and grid cells may be
  /// missing.
  [[nodiscard]] bool hasHead() const;
  /// Returns the relief of an object with the slices received so far. Returns null if the object
  /// has no relief, or if its head is missing.
  [[nodiscard]] std::shared_ptr<const CodedRelief> relief(const ObjectKey& object);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< bytes received so far
  /// Returns the frame as received so far. It has the objects whose heads are present, with their
  /// slices so far. A grid is included only if it is complete.
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

    /// Returns true if the grid has the right size for the relief, as far as both are received.
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
