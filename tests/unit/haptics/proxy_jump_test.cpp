// SPDX-License-Identifier: MIT
// The proxy on what appears, jumps and vanishes: nothing steps, nothing pulls.
#include <gtest/gtest.h>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

/// Largest step of the displacement over some still ticks, and the last contact.
struct Still {
  double step = 0.0;
  Contact contact;
};
Still stand(Table& table, const Vec3& hip_mm, int ticks, Vec3 last_mm) {
  Still still;
  for (int i = 0; i < ticks; ++i) {
    still.contact = table.touch(hip_mm);
    still.step = std::max(still.step, (still.contact.displacement_mm - last_mm).norm());
    last_mm = still.contact.displacement_mm;
  }
  return still;
}

TEST(ProxyJump, ASurfaceThatJumpsUpFadesIn) {
  for (const double jump_mm : {0.5, 2.0}) {
    Table table;
    table.put(1, relief(10.0, level(10.0)));
    Contact contact = table.move({0.0, 0.0, 12.0}, {0.0, 0.0, 9.5});
    ASSERT_NEAR(contact.displacement_mm.z(), 0.5, 1e-3);
    table.show(0, relief(10.0, level(10.0 + jump_mm)));
    const Still first = stand(table, {0.0, 0.0, 9.5}, 1, contact.displacement_mm);
    EXPECT_LT(first.step, 1e-6);  // begins where it was
    const Still after = stand(table, {0.0, 0.0, 9.5}, 119, first.contact.displacement_mm);
    EXPECT_LT(after.step, 0.06);
    EXPECT_NEAR(after.contact.displacement_mm.z(), 0.5 + jump_mm, 0.06 * jump_mm);
    EXPECT_FALSE(after.contact.jump);
  }
}

TEST(ProxyJump, AnObjectThatAppearsOverTheHipIsAJumpAtFullDepth) {
  Table table;
  table.put(1, relief(10.0, level(5.0)));
  const Vec3 hip(0.0, 0.0, 8.5);
  (void)table.touch(hip);
  table.put(2, relief(10.0, level(10.0)));  // 1.5 mm over it
  const Contact contact = table.touch(hip);
  EXPECT_TRUE(contact.jump);
  EXPECT_NEAR(contact.displacement_mm.z(), 1.5, 1e-3);
  EXPECT_EQ(contact.object->before->id, 2U);
  EXPECT_FALSE(table.touch(hip).jump);
}

TEST(ProxyJump, TooDeepItIsSilentUntilTheHandHasLeft) {
  Table table;
  table.put(1, relief(10.0, level(5.0)));
  const Vec3 hip(0.0, 0.0, 8.0);
  (void)table.touch(hip);
  table.put(2, relief(10.0, level(13.0)));  // 5 mm over it
  for (int i = 0; i < 300; ++i) ASSERT_FALSE(table.touch(hip).contact);
  for (double z = 8.0; z < 14.0; z += 0.02) ASSERT_FALSE(table.touch({0.0, 0.0, z}).contact);
  const Contact contact = table.move({0.0, 0.0, 14.0}, {0.0, 0.0, 12.0});
  EXPECT_NEAR(contact.displacement_mm.z(), 1.0, 1e-3);
}

TEST(ProxyJump, AnExistingContactThatIsBuriedEnds) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  (void)table.move({0.0, 0.0, 12.0}, {0.0, 0.0, 9.0});
  table.show(0, relief(10.0, level(15.0)));
  EXPECT_FALSE(table.touch({0.0, 0.0, 9.0}).contact);
  EXPECT_FALSE(table.touch({0.0, 0.0, 9.0}).contact);
}

TEST(ProxyJump, NothingPullsAHandThatRetreatsFromAFadingForce) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  (void)table.move({0.0, 0.0, 12.0}, {0.0, 0.0, 9.8});
  table.show(0, relief(10.0, level(12.0)));
  for (double z = 9.8; z < 12.5; z += 0.1) {
    const Contact contact = table.touch({0.0, 0.0, z});
    EXPECT_GE(contact.displacement_mm.z(), 0.0) << z;
  }
}

TEST(ProxyJump, AWallThatArrivesFadesIn) {
  Table table;
  const auto until = [](double x) {
    return relief(15.0, level(12.0), [=](const Vec2& at) { return at.x() < x; });
  };
  table.put(1, until(3.0));
  const Vec3 hip(4.0, 0.0, 5.0);
  (void)table.touch(hip);
  table.show(0, until(5.0));
  const Still still = stand(table, hip, 200, Vec3::Zero());
  EXPECT_LT(still.step, 0.06);
  EXPECT_NEAR(still.contact.displacement_mm.x(), 1.0, 0.03);
  EXPECT_EQ(still.contact.displacement_mm.z(), 0.0);
}

TEST(ProxyJump, APoseThatJumpsUnderTheHandFadesIn) {
  // A frame that came late says that the object is 2 mm higher, or aside, than it was carried on.
  for (const Vec3& jump : {Vec3(0.0, 0.0, 2.0), Vec3(-2.0, 0.0, 0.0)}) {
    Table table;
    const auto slope = [](const Vec2& at) { return 10.0 + 0.5 * at.x(); };
    InterpolatedObject& now = table.put(1, relief(15.0, slope));
    Contact contact = table.move({0.0, 0.0, 12.0}, {0.0, 0.0, 9.5});
    ASSERT_TRUE(contact.contact);
    now.position_mm += jump;
    const Still first = stand(table, {0.0, 0.0, 9.5}, 1, contact.displacement_mm);
    EXPECT_LT(first.step, 1e-6);
    const Still after = stand(table, {0.0, 0.0, 9.5}, 300, first.contact.displacement_mm);
    EXPECT_LT(after.step, 0.06);
  }
  // New contact made by it begins at zero.
  Table table;
  InterpolatedObject& now = table.put(1, relief(15.0, level(10.0)));
  (void)table.touch({0.0, 0.0, 10.5});
  now.position_mm.z() += 2.0;
  const Still still = stand(table, {0.0, 0.0, 10.5}, 200, Vec3::Zero());
  EXPECT_LT(still.step, 0.05);
  EXPECT_NEAR(still.contact.displacement_mm.z(), 1.5, 0.02);
}

TEST(ProxyJump, AnImpactIsNoJump) {
  Table table;
  InterpolatedObject& now = table.put(1, relief(15.0, level(10.0)));
  now.velocity_mm_s.z() = -1000.0;
  (void)table.touch({0.0, 0.0, 9.9});  // 0.1 mm deep
  // Half a millisecond down, half up again.
  now.velocity_mm_s.z() = 1000.0;
  (void)table.touch({0.0, 0.0, 9.9});
  now.position_mm.z() += 1.0;
  EXPECT_NEAR(table.touch({0.0, 0.0, 9.9}).displacement_mm.z(), 1.1, 1e-3);
}

TEST(ProxyJump, ReportsAJumpOfANewEpochAtFullDepth) {
  // The chain fades it and refuses to arm where it is too deep: it has to see how deep it is.
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  (void)table.touch({0.0, 0.0, 20.0});
  table.scene.jumped = true;
  const Contact contact = table.touch({0.0, 0.0, 7.5});
  EXPECT_TRUE(contact.jump);
  EXPECT_NEAR(contact.displacement_mm.z(), 2.5, 1e-3);
  table.scene.jumped = false;
  EXPECT_FALSE(table.touch({0.0, 0.0, 7.5}).jump);
  EXPECT_NEAR(table.touch({0.0, 0.0, 7.5}).displacement_mm.z(), 2.5, 1e-3);
}

TEST(ProxyJump, VanishingObjectsOnlyLetGo) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  (void)table.move({0.0, 0.0, 12.0}, {0.0, 0.0, 9.0});
  table.scene.object_count = 0;
  EXPECT_FALSE(table.touch({0.0, 0.0, 9.0}).contact);
  // Back again: it appears.
  table.scene.object_count = 1;
  const Contact back = table.touch({0.0, 0.0, 9.0});
  EXPECT_TRUE(back.jump);
  EXPECT_NEAR(back.displacement_mm.z(), 1.0, 1e-3);
}

TEST(ProxyJump, AnObjectUnderANewIdContinuesTheContact) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  const Contact before = table.move({0.0, 0.0, 12.0}, {0.3, 0.2, 8.5});
  for (std::uint32_t id = 2; id < 40; ++id) {
    table.scene.object_count = 0;
    table.put(id, relief(10.0, level(10.0 + 0.001 * id)));
    const Contact contact = table.touch({0.3, 0.2, 8.5});
    EXPECT_FALSE(contact.jump) << id;
    EXPECT_NEAR(contact.displacement_mm.z(), before.displacement_mm.z() + 0.001 * id, 1e-3);
    EXPECT_EQ(contact.object->before->id, id);
  }
  // Another height is another object.
  table.scene.object_count = 0;
  table.put(50, relief(10.0, level(10.5)));
  EXPECT_TRUE(table.touch({0.3, 0.2, 8.5}).jump);
}

}  // namespace
}  // namespace hapticast::client
