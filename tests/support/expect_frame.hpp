// SPDX-License-Identifier: MIT
// Expectations that frames of the library are equal. Times may differ by 1 ns, the step of the
// wire.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>

#include "common/include/hapticast/frame.hpp"

namespace hapticast {

inline void expectSame(const HeightMap& a, const HeightMap& b) {
  EXPECT_EQ(std::pair(a.left_px, a.top_px), std::pair(b.left_px, b.top_px));
  EXPECT_EQ(std::pair(a.width_px, a.height_px), std::pair(b.width_px, b.height_px));
  EXPECT_EQ(a.height_mm, b.height_mm);
  EXPECT_EQ(a.mask, b.mask);
}

inline void expectSame(const Object::Material& a, const Object::Material& b) {
  EXPECT_EQ(a.stiffness_N_mm, b.stiffness_N_mm);
  EXPECT_EQ(a.damping_Ns_m, b.damping_Ns_m);
  EXPECT_EQ(a.static_friction, b.static_friction);
  EXPECT_EQ(a.dynamic_friction, b.dynamic_friction);
  EXPECT_EQ(a.texture_K_mm, b.texture_K_mm);
  EXPECT_EQ(a.mass_kg, b.mass_kg);
}

inline void expectSame(const Object& a, const Object& b) {
  EXPECT_EQ(std::pair(a.id, a.layer), std::pair(b.id, b.layer));
  EXPECT_EQ(a.position_mm, b.position_mm);
  EXPECT_EQ(a.velocity_mm_s, b.velocity_mm_s);
  EXPECT_EQ(a.acceleration_mm_s2, b.acceleration_mm_s2);
  EXPECT_EQ(a.angle_rad, b.angle_rad);
  EXPECT_EQ(a.angular_velocity_rad_s, b.angular_velocity_rad_s);
  EXPECT_EQ(a.quality, b.quality);
  EXPECT_EQ(a.visible_fraction, b.visible_fraction);
  expectSame(a.material, b.material);
  ASSERT_EQ(a.heights == nullptr, b.heights == nullptr);
  if (a.heights) expectSame(*a.heights, *b.heights);
  ASSERT_EQ(a.cells == nullptr, b.cells == nullptr);
  if (a.cells) {
    EXPECT_EQ(a.cells->velocity_mm_s, b.cells->velocity_mm_s);
    EXPECT_EQ(a.cells->acceleration_mm_s2, b.cells->acceleration_mm_s2);
  }
  ASSERT_EQ(a.impacts.size(), b.impacts.size());
  for (std::size_t i = 0; i < a.impacts.size(); ++i) {
    EXPECT_NEAR(a.impacts[i].time_s, b.impacts[i].time_s, 1e-9);
    EXPECT_EQ(a.impacts[i].delta_velocity_mm_s, b.impacts[i].delta_velocity_mm_s);
  }
}

}  // namespace hapticast
