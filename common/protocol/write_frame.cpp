// SPDX-License-Identifier: MIT
#include "common/protocol/write_frame.hpp"

#include <vector>

namespace hapticast {

namespace {

void write(const Vec3& from, proto::Vec3& to) {
  to.set_x(static_cast<float>(from.x()));
  to.set_y(static_cast<float>(from.y()));
  to.set_z(static_cast<float>(from.z()));
}

void write(const Motion& from, proto::Motion& to) {
  write(from.position_mm, *to.mutable_position_mm());
  write(from.velocity_mm_s, *to.mutable_velocity_mm_s());
  write(from.acceleration_mm_s2, *to.mutable_acceleration_mm_s2());
  to.set_angle_rad(static_cast<float>(from.angle_rad));
  to.set_angular_velocity_rad_s(static_cast<float>(from.angular_velocity_rad_s));
  to.set_reference_point(static_cast<proto::ReferencePoint>(from.reference_point));
  to.set_quality(static_cast<float>(from.quality));
  to.set_visible_fraction(static_cast<float>(from.visible_fraction));
}

}  // namespace

void writeMaterial(const Material& from, proto::Material& to) {
  const auto given = [](const std::optional<double>& value) { return static_cast<float>(*value); };
  if (from.stiffness_N_mm) to.set_stiffness_n_mm(given(from.stiffness_N_mm));
  if (from.damping_Ns_m) to.set_damping_ns_m(given(from.damping_Ns_m));
  if (from.static_friction) to.set_static_friction(given(from.static_friction));
  if (from.dynamic_friction) to.set_dynamic_friction(given(from.dynamic_friction));
  if (from.texture_K_mm) to.set_texture_k_mm(given(from.texture_K_mm));
  if (from.mass_kg) to.set_mass_kg(given(from.mass_kg));
}

void writeRect(const PixelRect& from, proto::Relief& to) {
  to.set_u(static_cast<std::uint32_t>(from.u));
  to.set_v(static_cast<std::uint32_t>(from.v));
  to.set_width(static_cast<std::uint32_t>(from.width));
  to.set_height(static_cast<std::uint32_t>(from.height));
}

void writeCells(const MotionGrid& from, std::size_t first, std::size_t most,
                proto::MotionGrid& to) {
  to.set_columns(static_cast<std::uint32_t>(from.columns));
  to.set_rows(static_cast<std::uint32_t>(from.rows));
  if (to.velocity_mm_s_size() == 0) to.set_first_cell(static_cast<std::uint32_t>(first));
  const auto put = [first, most](const std::vector<Eigen::Vector3f>& cells, auto& out) {
    for (std::size_t i = first; i < cells.size() && i - first < most; ++i)
      out.Add(cells[i].begin(), cells[i].end());
  };
  put(from.velocity_mm_s, *to.mutable_velocity_mm_s());
  put(from.acceleration_mm_s2, *to.mutable_acceleration_mm_s2());
}

void writeHead(const CodedObject& from, proto::Object& to) {
  to.set_id(from.id);
  to.set_layer(from.layer);
  to.set_changed_in_frame(from.changed_in_frame);
  write(from.motion, *to.mutable_motion());
  for (const Impact& impact : from.impacts) {
    auto& hit = *to.add_impacts();
    hit.set_time_ns(impact.time.time_since_epoch().count());
    write(impact.delta_velocity_mm_s, *hit.mutable_delta_velocity_mm_s());
  }
  if (from.material != Material{}) writeMaterial(from.material, *to.mutable_material());
}

void writeFrame(const CodedFrame& from, proto::HapticFrame& to) {
  to.set_epoch(from.epoch);
  to.set_id(from.id);
  to.set_media_time_ns(from.media_time.time_since_epoch().count());
  for (const CodedObject& object : from.objects) {
    auto& out = *to.add_objects();
    writeHead(object, out);
    if (object.grid) {
      writeCells(*object.grid, 0, object.grid->velocity_mm_s.size(),
                 *out.mutable_motion()->mutable_grid());
    }
    if (!object.relief) continue;
    writeRect(object.relief->rect, *out.mutable_relief());
    for (const SliceBytes& slice : object.relief->slices)
      out.mutable_relief()->add_slices(slice.data(), slice.size());
  }
}

}  // namespace hapticast
