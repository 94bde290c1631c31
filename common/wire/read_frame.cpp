// SPDX-License-Identifier: MIT
#include "common/wire/read_frame.hpp"

#include <utility>
#include <vector>

#include "common/wire/limits.hpp"
#include "common/wire/scan.hpp"
#include "common/wire/slice/header.hpp"

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

using Floats = google::protobuf::RepeatedField<float>;

std::vector<Eigen::Vector3f> vectors(const Floats& from, double limit, Check& check) {
  std::vector<Eigen::Vector3f> to(static_cast<std::size_t>(from.size()) / 3);
  for (int i = 0; i < from.size(); ++i) {
    to[static_cast<std::size_t>(i) / 3][i % 3] = from.Get(i);
    check.magnitude(from.Get(i), limit, "a grid's value is out of range");
  }
  return to;
}

std::shared_ptr<const MotionGrid> read(const proto::MotionGrid& from, const proto::Object& object,
                                       Check& check) {
  check.require(from.columns() >= 1 && from.columns() <= gridCells(unsigned{kMaxWidth_px}) &&
                    from.rows() >= 1 && from.rows() <= gridCells(unsigned{kMaxHeight_px}),
                "a grid's size is out of range");
  if (object.has_relief()) {
    check.require(from.columns() == gridCells(object.relief().width()) &&
                      from.rows() == gridCells(object.relief().height()),
                  "a grid does not cover its relief");
  }
  const auto values = 3ULL * from.columns() * from.rows();
  check.require(static_cast<unsigned>(from.velocity_mm_s_size()) == values &&
                    static_cast<unsigned>(from.acceleration_mm_s2_size()) == values,
                "a grid has the wrong number of values");
  if (check.error()) return nullptr;
  auto to = std::make_shared<MotionGrid>();
  to->columns = static_cast<int>(from.columns());
  to->rows = static_cast<int>(from.rows());
  to->velocity_mm_s = vectors(from.velocity_mm_s(), limits::kVelocity_mm_s, check);
  to->acceleration_mm_s2 = vectors(from.acceleration_mm_s2(), limits::kAcceleration_mm_s2, check);
  return to;
}

Material read(const proto::Material& from, Check& check) {
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
  };
}

/// Cells of a relief that slices have claimed so far.
class CoveredCells {
 public:
  explicit CoveredCells(const PixelRect& rect)
      : columns_(codec::cellsOver(rect.width)),
        covered_(static_cast<std::size_t>(columns_) *
                 static_cast<std::size_t>(codec::cellsOver(rect.height))) {}

  /// False where one of them was claimed before.
  bool claim(const codec::Header& slice) {
    bool free = true;
    for (int y = slice.y; y < slice.y + slice.rows; ++y) {
      for (int x = slice.x; x < slice.x + slice.columns; ++x) {
        std::vector<bool>::reference cell = covered_[static_cast<std::size_t>(y * columns_ + x)];
        free = free && !cell;
        cell = true;
      }
    }
    return free;
  }

 private:
  int columns_;
  std::vector<bool> covered_;
};

PixelRect rectOf(const proto::Relief& from, Check& check) {
  check.require(from.width() >= 1 && from.width() <= static_cast<unsigned>(kMaxWidth_px) &&
                    from.height() >= 1 && from.height() <= static_cast<unsigned>(kMaxHeight_px) &&
                    from.u() <= static_cast<unsigned>(kMaxWidth_px) - from.width() &&
                    from.v() <= static_cast<unsigned>(kMaxHeight_px) - from.height(),
                "a relief's rectangle is empty or leaves 1920 x 1080");
  if (check.error()) return {};
  return {static_cast<int>(from.u()), static_cast<int>(from.v()), static_cast<int>(from.width()),
          static_cast<int>(from.height())};
}

std::shared_ptr<const CodedRelief> read(const proto::Relief& from, Check& check) {
  auto to = std::make_shared<CodedRelief>();
  to->rect = rectOf(from, check);
  check.require(from.slices_size() > 0, "a relief without a slice");
  if (check.error()) return nullptr;
  CoveredCells covered(to->rect);
  to->slices.reserve(static_cast<std::size_t>(from.slices_size()));
  for (const std::string& slice : from.slices()) {
    check.bound(slice.size(), kMostSliceBytes, "a slice is too long");
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(slice.data());
    const auto header = codec::Header::read({bytes, slice.size()}, to->rect);
    if (!header.ok()) check.take(header.error());
    if (check.error()) return nullptr;
    check.require(covered.claim(header.value()), "two slices of a relief overlap");
    to->slices.emplace_back(bytes, bytes + slice.size());
  }
  to->slice_count = to->slices.size();
  return to;
}

CodedObject read(const proto::Object& from, std::uint64_t frame_id, Check& check) {
  CodedObject to;
  to.id = from.id();
  to.layer = from.layer();
  check.require(to.layer < kMaxObjects, "a layer is not 0..15");
  to.changed_in_frame = from.changed_in_frame();
  check.require(to.changed_in_frame <= frame_id, "a relief changed in a later frame");
  to.motion = read(from.motion(), check);
  if (from.motion().has_grid()) to.grid = read(from.motion().grid(), from, check);
  check.bound(static_cast<std::size_t>(from.impacts_size()), kMaxImpacts, "too many impacts");
  if (check.error()) return to;
  for (const proto::Impact& impact : from.impacts()) {
    to.impacts.push_back({MediaTime(check.time(impact.time_ns())),
                          read(impact.delta_velocity_mm_s(), limits::kVelocity_mm_s, check)});
  }
  if (from.has_material()) to.material = read(from.material(), check);
  if (from.has_relief() && !check.error()) to.relief = read(from.relief(), check);
  return to;
}

/// A slice covers at least one cell. The parser would put the slices of several reliefs together.
void boundSlices(std::span<const std::uint8_t> object, Check& check) {
  constexpr std::size_t kMostSlices =
      std::size_t{codec::cellsOver(kMaxWidth_px)} * std::size_t{codec::cellsOver(kMaxHeight_px)};
  const auto reliefs = submessages(object, proto::Object::kReliefFieldNumber, 1);
  check.require(reliefs.has_value(), "an object has two reliefs");
  if (!reliefs || reliefs->empty()) return;
  const auto slices = submessages(reliefs->front(), proto::Relief::kSlicesFieldNumber, kMostSlices);
  check.bound(slices ? slices->size() : kMostSlices + 1, kMostSlices, "too many slices");
}

}  // namespace

void boundCounts(std::span<const std::uint8_t> bytes, Check& check) {
  const auto frames = submessages(bytes, proto::Message::kFrameFieldNumber, 1);
  check.require(frames.has_value(), "more than one frame in a message");
  if (!frames || frames->empty()) return;
  const auto objects =
      submessages(frames->front(), proto::HapticFrame::kObjectsFieldNumber, kMaxObjects);
  check.bound(objects ? objects->size() : kMaxObjects + 1, kMaxObjects, "too many objects");
  if (!objects) return;
  for (const auto object : *objects) {
    const auto impacts = submessages(object, proto::Object::kImpactsFieldNumber, kMaxImpacts);
    check.bound(impacts ? impacts->size() : kMaxImpacts + 1, kMaxImpacts, "too many impacts");
    boundSlices(object, check);
  }
}

CodedFrame readFrame(const proto::HapticFrame& from, Check& check) {
  CodedFrame to;
  to.epoch = from.epoch();
  to.id = from.id();
  to.media_time = MediaTime(check.time(from.media_time_ns()));
  check.bound(static_cast<std::size_t>(from.objects_size()), kMaxObjects, "too many objects");
  std::uint64_t pixels = 0;
  for (const proto::Object& object : from.objects()) {
    pixels += static_cast<std::uint64_t>(object.relief().width()) * object.relief().height();
    check.bound(pixels, kMaxReliefPixels, "the reliefs of a frame cover too many pixels");
    if (check.error()) break;
    to.objects.push_back(read(object, to.id, check));
    for (std::size_t i = 0; i + 1 < to.objects.size(); ++i) {
      check.require(to.objects[i].id != object.id() || to.objects[i].layer != object.layer(),
                    "an object appears twice");
    }
  }
  return to;
}

}  // namespace hapticast
