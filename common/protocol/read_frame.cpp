// SPDX-License-Identifier: MIT
#include "common/protocol/read_frame.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/codec/slice/covered_cells.hpp"
#include "common/protocol/scan.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

Vec3 read(const proto::Vec3& from, double limit, Check& check) {
  for (const float each : {from.x(), from.y(), from.z()})
    check.magnitude(each, limit, "a vector is out of range");
  return {from.x(), from.y(), from.z()};
}

Motion read(const proto::Motion& from, Check& check) {
  Motion to;
  to.position_mm = read(from.position_mm(), limits::kPosition_mm, check);
  to.velocity_mm_s = read(from.velocity_mm_s(), limits::kVelocity_mm_s, check);
  to.acceleration_mm_s2 = read(from.acceleration_mm_s2(), limits::kAcceleration_mm_s2, check);
  to.angle_rad = check.magnitude(from.angle_rad(), limits::kAngle_rad, "an angle is out of range");
  to.angular_velocity_rad_s =
      check.magnitude(from.angular_velocity_rad_s(), limits::kAngularVelocity_rad_s,
                      "an angular velocity is out of range");
  check.require(proto::ReferencePoint_IsValid(from.reference_point()),
                "an unknown reference point");
  to.reference_point = static_cast<ReferencePoint>(from.reference_point());
  to.quality = check.number(from.quality(), 0.0, 1.0, "a quality is not 0..1");
  to.visible_fraction =
      check.number(from.visible_fraction(), 0.0, 1.0, "a visible fraction is not 0..1");
  return to;
}

template <class Floats>
std::vector<Eigen::Vector3f> vectors(const Floats& from, double limit, Check& check) {
  std::vector<Eigen::Vector3f> to(static_cast<std::size_t>(from.size()) / 3);
  for (int i = 0; i < from.size(); ++i) {
    to[static_cast<std::size_t>(i) / 3][i % 3] = from.Get(i);
    check.magnitude(from.Get(i), limit, "a grid's value is out of range");
  }
  return to;
}

/// Part of a grid in a message.
struct GridPart {
  std::shared_ptr<const MotionGrid> grid;
  std::size_t first_cell = 0;
};

GridPart read(const proto::MotionGrid& from, bool in_pieces, Check& check) {
  check.require(from.columns() >= 1 && from.columns() <= gridCells(unsigned{kMaxWidth_px}) &&
                    from.rows() >= 1 && from.rows() <= gridCells(unsigned{kMaxHeight_px}),
                "a grid's size is out of range");
  const auto all = 3ULL * from.columns() * from.rows();
  const auto before = 3ULL * from.first_cell();
  const auto values = static_cast<std::uint64_t>(from.velocity_mm_s_size());
  const bool fits = in_pieces ? values > 0 && values % 3 == 0 && before + values <= all
                              : values == all && before == 0;
  check.require(fits && from.acceleration_mm_s2_size() == from.velocity_mm_s_size(),
                "a grid has the wrong number of values");
  if (check.error()) return {};
  auto to = std::make_shared<MotionGrid>();
  to->columns = static_cast<int>(from.columns());
  to->rows = static_cast<int>(from.rows());
  to->velocity_mm_s = vectors(from.velocity_mm_s(), limits::kVelocity_mm_s, check);
  to->acceleration_mm_s2 = vectors(from.acceleration_mm_s2(), limits::kAcceleration_mm_s2, check);
  return {std::move(to), from.first_cell()};
}

/// A slice covers at least one cell.
constexpr std::size_t kMostSlices =
    std::size_t{codec::countCells(kMaxWidth_px)} * std::size_t{codec::countCells(kMaxHeight_px)};

PixelRect parseRect(const proto::Relief& from, Check& check) {
  check.require(from.width() >= 1 && from.width() <= static_cast<unsigned>(kMaxWidth_px) &&
                    from.height() >= 1 && from.height() <= static_cast<unsigned>(kMaxHeight_px) &&
                    from.u() <= static_cast<unsigned>(kMaxWidth_px) - from.width() &&
                    from.v() <= static_cast<unsigned>(kMaxHeight_px) - from.height(),
                "a relief's rectangle is empty or leaves 1920 x 1080");
  if (check.error()) return {};
  return {static_cast<int>(from.u()), static_cast<int>(from.v()), static_cast<int>(from.width()),
          static_cast<int>(from.height())};
}

std::shared_ptr<const CodedRelief> read(const proto::Relief& from, bool in_pieces, Check& check) {
  auto to = std::make_shared<CodedRelief>();
  to->rect = parseRect(from, check);
  check.require(from.slices_size() > 0 || (in_pieces && from.slice_count() > 0),
                "a relief without a slice");
  check.bound(from.slice_count(), kMostSlices, "too many slices");
  if (check.error()) return nullptr;
  to->slices.reserve(static_cast<std::size_t>(from.slices_size()));
  for (const std::string& slice : from.slices()) {
    check.bound(slice.size(), kMostSliceBytes, "a slice is too long");
    check.require(slice.size() >= kLeastSliceBytes, "a slice is too short");
    if (check.error()) return nullptr;
    to->slices.emplace_back(slice.begin(), slice.end());
  }
  to->slice_count = in_pieces ? from.slice_count() : to->slices.size();
  return to;
}

/// Reads motion, impacts and material.
void readHead(const proto::Object& from, std::uint64_t frame_id, CodedObject& to, Check& check) {
  to.changed_in_frame = from.changed_in_frame();
  check.require(to.changed_in_frame <= frame_id, "a relief changed in a later frame");
  to.motion = read(from.motion(), check);
  check.bound(static_cast<std::size_t>(from.impacts_size()), kMaxImpacts, "too many impacts");
  if (check.error()) return;
  for (const proto::Impact& impact : from.impacts()) {
    to.impacts.push_back({MediaTime(check.time(impact.time_ns())),
                          read(impact.delta_velocity_mm_s(), limits::kVelocity_mm_s, check)});
  }
  if (from.has_material()) to.material = readMaterial(from.material(), check);
}

ObjectPiece read(const proto::Object& from, std::uint64_t frame_id, bool in_pieces, Check& check) {
  ObjectPiece to;
  to.object.id = from.id();
  to.object.layer = from.layer();
  check.require(from.layer() < kMaxObjects, "a layer is not 0..15");
  check.require(in_pieces || !from.rest(), "an object in parts where it has to be whole");
  to.head = !from.rest();
  if (to.head) readHead(from, frame_id, to.object, check);
  if (from.motion().has_grid() && !check.error()) {
    GridPart part = read(from.motion().grid(), in_pieces, check);
    to.object.grid = std::move(part.grid);
    to.first_cell = part.first_cell;
  }
  if (from.has_relief() && !check.error()) to.object.relief = read(from.relief(), in_pieces, check);
  return to;
}

/// Reads all objects; none after an error of the check.
std::vector<ObjectPiece> readObjects(const proto::HapticFrame& from, std::uint64_t frame_id,
                                     bool in_pieces, Check& check) {
  std::vector<ObjectPiece> to;
  check.bound(static_cast<std::size_t>(from.objects_size()), kMaxObjects, "too many objects");
  for (const proto::Object& object : from.objects()) {
    if (check.error()) return {};
    to.push_back(read(object, frame_id, in_pieces, check));
  }
  return to;
}

void checkRelief(const CodedRelief& relief, Check& check) {
  check.require(relief.slice_count == 0 || relief.slices.size() <= relief.slice_count,
                "a relief has more slices than it says");
  codec::CoveredCells covered(relief.rect);
  for (const SliceBytes& slice : relief.slices) {
    const auto header = codec::Header::read(slice, relief.rect);
    if (!header.ok()) return check.adopt(header.error());
    check.require(covered.claim(header.value()), "two slices of a relief overlap");
  }
}

void checkObject(const CodedObject& object, Check& check) {
  if (!object.relief) return;
  const PixelRect& rect = object.relief->rect;
  if (object.grid) {
    check.require(object.grid->columns == gridCells(rect.width) &&
                      object.grid->rows == gridCells(rect.height),
                  "a grid does not cover its relief");
  }
  checkRelief(*object.relief, check);
}

/// The parser would merge the slices of several reliefs.
void boundSlices(std::span<const std::uint8_t> object, Check& check) {
  const auto reliefs = submessages(object, proto::Object::kReliefFieldNumber, 1);
  check.require(reliefs.has_value(), "an object has two reliefs");
  if (!reliefs || reliefs->empty()) return;
  const auto slices = submessages(reliefs->front(), proto::Relief::kSlicesFieldNumber, kMostSlices);
  check.bound(slices ? slices->size() : kMostSlices + 1, kMostSlices, "too many slices");
}

CodedFrame readWholeFrame(const proto::HapticFrame& from, bool in_pieces, Check& check) {
  CodedFrame to{from.epoch(), from.id(), MediaTime(check.time(from.media_time_ns())), {}};
  std::vector<ObjectPiece> objects = readObjects(from, to.id, in_pieces, check);
  to.objects.reserve(objects.size());
  for (ObjectPiece& each : objects) to.objects.push_back(std::move(each.object));
  if (!check.error()) checkFrame(to, check);
  return to;
}

}  // namespace

Material readMaterial(const proto::Material& from, Check& check) {
  const auto value = [&](bool given, float number, double limit) -> std::optional<double> {
    if (!given) return std::nullopt;
    return check.number(number, 0.0, limit, "a material's value is out of range");
  };
  return {
      value(from.has_stiffness_n_mm(), from.stiffness_n_mm(), limits::kStiffness_N_mm),
      value(from.has_damping_ns_m(), from.damping_ns_m(), limits::kDamping_Ns_m),
      value(from.has_static_friction(), from.static_friction(), limits::kFriction),
      value(from.has_dynamic_friction(), from.dynamic_friction(), limits::kFriction),
      value(from.has_texture_k_mm(), from.texture_k_mm(), limits::kWorkspace_mm),
      value(from.has_mass_kg(), from.mass_kg(), limits::kMass_kg),
  };
}

void boundCounts(std::span<const std::uint8_t> message, Check& check) {
  boundCountsOfContent(message, proto::Message::kFrameFieldNumber, check);
}

void boundCountsOfContent(std::span<const std::uint8_t> message, std::uint32_t field,
                          Check& check) {
  const auto frames = submessages(message, field, 1);
  check.require(frames.has_value(), "more than one frame in a message");
  if (frames && !frames->empty()) boundCountsOfFrame(frames->front(), check);
}

void boundCountsOfFrame(std::span<const std::uint8_t> frame, Check& check) {
  const auto objects = submessages(frame, proto::HapticFrame::kObjectsFieldNumber, kMaxObjects);
  check.bound(objects ? objects->size() : kMaxObjects + 1, kMaxObjects, "too many objects");
  if (!objects) return;
  for (const auto object : *objects) {
    const auto impacts = submessages(object, proto::Object::kImpactsFieldNumber, kMaxImpacts);
    check.bound(impacts ? impacts->size() : kMaxImpacts + 1, kMaxImpacts, "too many impacts");
    boundSlices(object, check);
  }
}

CodedFrame readFrame(const proto::HapticFrame& from, Check& check) {
  return readWholeFrame(from, false, check);
}

CodedFrame readAssembledFrame(const proto::HapticFrame& from, Check& check) {
  for (const proto::Object& object : from.objects())
    check.require(!object.rest(), "an object in parts where it has to be whole");
  return readWholeFrame(from, true, check);
}

FramePiece readFramePiece(const proto::HapticFrame& from, std::uint64_t frame_id, Check& check) {
  FramePiece piece{readObjects(from, frame_id, true, check)};
  check.bound(from.object_count(), kMaxObjects, "too many objects");
  const bool rest = std::all_of(piece.objects.begin(), piece.objects.end(),
                                [](const ObjectPiece& each) { return !each.head; });
  if (piece.objects.empty() || !rest) piece.object_count = from.object_count();
  CodedFrame frame;
  frame.objects.reserve(piece.objects.size());
  for (const ObjectPiece& each : piece.objects) frame.objects.push_back(each.object);
  if (!check.error()) checkFrame(frame, check);
  return piece;
}

void checkFrame(const CodedFrame& frame, Check& check) {
  check.bound(frame.objects.size(), kMaxObjects, "too many objects");
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    const CodedObject& object = frame.objects[i];
    for (std::size_t j = 0; j < i; ++j) {
      check.require(makeKey(frame.objects[j]) != makeKey(object), "an object appears twice");
    }
    if (!object.relief) continue;
    pixels += object.relief->rect.pixels();
    check.bound(pixels, kMaxReliefPixels, "the reliefs of a frame cover too many pixels");
  }
  for (const CodedObject& object : frame.objects) {
    if (!check.error()) checkObject(object, check);
  }
}

}  // namespace hapticast
