// SPDX-License-Identifier: MIT
// Joins the fragments of a frame (fragment.hpp); fragment.cpp makes them.
#include <algorithm>
#include <utility>

#include "common/protocol/fragment.hpp"
#include "common/protocol/read_frame.hpp"
#include "common/transport/framing.hpp"

namespace hapticast {

namespace {

/// Returns whether two headers belong to the same frame.
bool isSameFrame(DatagramHeader a, const DatagramHeader& b) {
  a.part = b.part;
  return a == b;
}

/// Returns the relief with sorted slices, so that the bytes do not depend on the order of arrival.
std::shared_ptr<const CodedRelief> sortSlices(CodedRelief relief) {
  std::sort(relief.slices.begin(), relief.slices.end());
  return std::make_shared<const CodedRelief>(std::move(relief));
}

}  // namespace

Result<FramePiece, WireError> readPiece(std::span<const std::uint8_t> payload,
                                        std::uint64_t frame) {
  Check check;
  check.bound(payload.size(), kMostPieceBytes, "a piece is too long");
  if (!check.error()) boundCountsOfFrame(payload, check);
  proto::HapticFrame parsed;
  if (!check.error()) {
    check.require(parsed.ParseFromArray(payload.data(), static_cast<int>(payload.size())),
                  "bytes that are not a piece");
  }
  if (check.error()) return *check.error();
  FramePiece piece = readFramePiece(parsed, frame, check);
  if (check.error()) return *check.error();
  return piece;
}

Reassembly::Reassembly(const DatagramHeader& any_part) : header_(any_part), had_(any_part.parts) {}

bool Reassembly::lacks(const DatagramHeader& part) const {
  return isSameFrame(part, header_) && part.part < had_.size() && !had_[part.part];
}

std::optional<WireError> Reassembly::add(const DatagramHeader& part,
                                         std::span<const std::uint8_t> payload) {
  if (!lacks(part)) return malformed("a part that arrived before, or a part of another frame");
  if (bytes_ + payload.size() > kMaxMessageBytes)
    return WireError{ErrorCode::kTooLarge, "a frame of more than 8 MiB"};
  auto piece = readPiece(payload, header_.frame);
  if (!piece.ok()) return piece.error();
  if (const auto count = piece.value().object_count) {
    if (object_count_.value_or(*count) != *count) return malformed("pieces of two frames");
    object_count_ = count;
  }
  for (const ObjectPiece& each : piece.value().objects) {
    if (auto error = addFragment(each)) return error;
  }
  bytes_ += payload.size();
  had_[part.part] = true;
  ++had_count_;
  return std::nullopt;
}

std::optional<WireError> Reassembly::addFragment(const ObjectPiece& piece) {
  const CodedObject& from = piece.object;
  const ObjectKey key = makeKey(from);
  if (!objects_.contains(key) && objects_.size() == kMaxObjects)
    return WireError{ErrorCode::kTooLarge, "too many objects"};
  Joined& to = objects_[key];
  if (piece.head && to.head) return malformed("an object appears twice");
  if (from.relief && to.relief.rect.empty()) pixels_ += from.relief->rect.pixels();
  if (pixels_ > kMaxReliefPixels)
    return WireError{ErrorCode::kTooLarge, "the reliefs of a frame cover too many pixels"};
  if (from.relief && !addRelief(*from.relief, piece.head, to))
    return malformed("parts of a relief that contradict each other");
  if (from.grid && !addGrid(*from.grid, piece.first_cell, to))
    return malformed("parts of a grid that contradict each other");
  if (!to.covers()) return malformed("a grid that does not cover its relief");
  if (piece.head) {
    to.object = piece.object;
    to.head = true;
  }
  return std::nullopt;
}

bool Reassembly::Joined::covers() const {
  return cells.empty() || relief.rect.empty() ||
         (grid.columns == gridCells(relief.rect.width) &&
          grid.rows == gridCells(relief.rect.height));
}

bool Reassembly::addRelief(const CodedRelief& piece, bool head, Joined& to) {
  if (!to.covered) {
    to.relief.rect = piece.rect;
    to.covered.emplace(piece.rect);
  }
  if (to.relief.rect != piece.rect) return false;
  to.in_order.reset();
  if (head) to.relief.slice_count = piece.slice_count;
  for (const SliceBytes& slice : piece.slices) {
    const auto header = codec::Header::read(slice, piece.rect);
    if (!header.ok() || !to.covered->claim(header.value())) return false;
    to.relief.slices.push_back(slice);
  }
  const bool known = to.head || head;
  return !known || to.relief.slices.size() <= to.relief.slice_count;
}

bool Reassembly::addGrid(const MotionGrid& piece, std::size_t first_cell, Joined& to) {
  const auto cells = static_cast<std::size_t>(piece.columns) * static_cast<std::size_t>(piece.rows);
  if (to.cells.empty()) {
    to.grid = {piece.columns, piece.rows, {}, {}};
    to.grid.velocity_mm_s.resize(cells);
    to.grid.acceleration_mm_s2.resize(cells);
    to.cells.resize(cells);
  }
  if (to.grid.columns != piece.columns || to.grid.rows != piece.rows) return false;
  for (std::size_t i = 0; i < piece.velocity_mm_s.size(); ++i) {
    if (to.cells[first_cell + i]) return false;
    to.cells[first_cell + i] = true;
    to.grid.velocity_mm_s[first_cell + i] = piece.velocity_mm_s[i];
    to.grid.acceleration_mm_s2[first_cell + i] = piece.acceleration_mm_s2[i];
  }
  return true;
}

bool Reassembly::hasHead() const {
  const auto heads = std::count_if(objects_.begin(), objects_.end(),
                                   [](const auto& each) { return each.second.head; });
  return object_count_ == static_cast<std::size_t>(heads);
}

std::shared_ptr<const CodedRelief> Reassembly::relief(const ObjectKey& object) {
  const auto found = objects_.find(object);
  if (found == objects_.end() || !found->second.head || !found->second.object.relief)
    return nullptr;
  Joined& from = found->second;
  if (!from.in_order) from.in_order = sortSlices(from.relief);
  return from.in_order;
}

CodedFrame Reassembly::frame() const {
  CodedFrame frame{header_.epoch, header_.frame, header_.media_time, {}};
  frame.objects.reserve(objects_.size());
  for (const auto& [key, each] : objects_) {
    if (!each.head) continue;
    CodedObject& object = frame.objects.emplace_back(each.object);
    if (object.relief) object.relief = sortSlices(each.relief);
    object.grid = nullptr;
    if (!each.cells.empty() &&
        std::all_of(each.cells.begin(), each.cells.end(), [](bool had) { return had; }))
      object.grid = std::make_shared<const MotionGrid>(each.grid);
  }
  return frame;
}

}  // namespace hapticast
