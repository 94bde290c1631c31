// SPDX-License-Identifier: MIT
#include "common/protocol/fragment.hpp"

#include <utility>

#include "common/protocol/write_frame.hpp"
#include "common/transport/framing.hpp"

namespace hapticast {

namespace {

/// Chosen: 960 bytes, which leave room for the rest of the fragment.
constexpr std::size_t kCellsInPiece = 40;

class Fragmenter {
 public:
  explicit Fragmenter(std::size_t object_count)
      : object_count_(static_cast<std::uint32_t>(object_count)) {}

  void head(const CodedObject& object) {
    add(object, [&object](proto::Object& to) {
      to.set_rest(false);
      writeHead(object, to);
      if (!object.relief) return;
      writeRect(object.relief->rect, *to.mutable_relief());
      to.mutable_relief()->set_slice_count(
          static_cast<std::uint32_t>(object.relief->slices.size()));
    });
  }
  void slice(const CodedObject& object, const SliceBytes& slice) {
    add(object, [&](proto::Object& to) {
      writeRect(object.relief->rect, *to.mutable_relief());
      to.mutable_relief()->add_slices(slice.data(), slice.size());
    });
  }
  void cells(const CodedObject& object, std::size_t first) {
    add(object, [&](proto::Object& to) {
      writeCells(*object.grid, first, kCellsInPiece, *to.mutable_motion()->mutable_grid());
    });
  }
  /// Returns the payloads: at least one, which may be empty.
  std::vector<std::vector<std::uint8_t>> finish() {
    flush();
    const bool small = pieces_.size() <= kMostParts && bytes_ <= kMaxMessageBytes;
    return small ? std::move(pieces_) : std::vector<std::vector<std::uint8_t>>();
  }

 private:
  /// Adds to the present fragment, or to a new one if it does not fit.
  template <class Put>
  void add(const CodedObject& object, const Put& put) {
    proto::HapticFrame grown = piece_;
    into(grown, object, put);
    if (grown.ByteSizeLong() > kMostPieceBytes) {
      flush();
      grown.Clear();
      into(grown, object, put);
    }
    piece_ = std::move(grown);
  }
  template <class Put>
  void into(proto::HapticFrame& piece, const CodedObject& object, const Put& put) const {
    proto::Object& to = addObject(piece, object);
    put(to);
    if (!to.rest()) piece.set_object_count(object_count_);
  }
  static proto::Object& addObject(proto::HapticFrame& piece, const CodedObject& object) {
    for (proto::Object& each : *piece.mutable_objects()) {
      if (each.id() == object.id && each.layer() == object.layer) return each;
    }
    proto::Object& added = *piece.add_objects();
    added.set_id(object.id);
    added.set_layer(object.layer);
    added.set_rest(true);
    return added;
  }
  void flush() {
    std::vector<std::uint8_t> payload(piece_.ByteSizeLong());
    piece_.SerializeWithCachedSizesToArray(payload.data());
    bytes_ += payload.size();
    pieces_.push_back(std::move(payload));
    piece_.Clear();
  }

  std::uint32_t object_count_;
  proto::HapticFrame piece_;
  std::vector<std::vector<std::uint8_t>> pieces_;
  std::size_t bytes_ = 0;
};

}  // namespace

std::vector<std::vector<std::uint8_t>> packFrame(const CodedFrame& frame) {
  Fragmenter packer(frame.objects.size());
  for (const CodedObject& object : frame.objects) packer.head(object);
  for (const CodedObject& object : frame.objects) {
    const std::size_t cells = object.grid ? object.grid->velocity_mm_s.size() : 0;
    for (std::size_t i = 0; i < cells; i += kCellsInPiece) packer.cells(object, i);
    if (!object.relief) continue;
    for (const SliceBytes& slice : object.relief->slices) packer.slice(object, slice);
  }
  return packer.finish();
}

}  // namespace hapticast
