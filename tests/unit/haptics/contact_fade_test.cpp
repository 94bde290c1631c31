// SPDX-License-Identifier: MIT
#include "client/haptics/safety/contact_fade.hpp"

#include <gtest/gtest.h>

#include <random>

#include "client/haptics/safety/safety_action.hpp"

namespace hapticast::client {
namespace {

FadeTick springAt(double depth_mm, double stiffness_N_mm = 0.5) {
  FadeTick tick;
  tick.touchable = true;
  tick.contact = depth_mm > 0.0;
  tick.spring_mJ = 0.5 * stiffness_N_mm * depth_mm * depth_mm;
  tick.full_N = tick.full_static_N = {0.0, 0.0, stiffness_N_mm * depth_mm};
  return tick;
}

TEST(DiscontinuityAccount, PaysAtMostItsContentAndRefills) {
  DiscontinuityAccount account;
  EXPECT_EQ(account.pay(-1.0), 0.0);
  EXPECT_EQ(account.pay(2.0), 2.0);
  EXPECT_NEAR(account.pay(2.0), 1.0, 1e-12);
  for (int tick = 0; tick < 1000; ++tick) account.refill();
  EXPECT_NEAR(account.content_mJ(), 1.5, 1e-9);
  for (int tick = 0; tick < 5000; ++tick) account.refill();
  EXPECT_EQ(account.content_mJ(), 3.0);
}

TEST(ContactFade, RisesFreelyInTheAirAndPaysInContact) {
  DiscontinuityAccount account;
  ContactFade fade(0.1, true, true);
  for (int tick = 0; tick < 200; ++tick) (void)fade.step(springAt(0.0), account);
  EXPECT_EQ(fade.gain(), 1.0);
  EXPECT_EQ(account.content_mJ(), 3.0);

  ContactFade pressed(0.1, true, true);
  for (int tick = 0; tick < 200; ++tick) (void)pressed.step(springAt(2.0), account);
  EXPECT_NEAR(pressed.gain(), 1.0, 1e-12);
  EXPECT_NEAR(account.content_mJ(), 2.0, 1e-9);  // a spring of 1 mJ
}

TEST(ContactFade, AnEmptyAccountHoldsTheGain) {
  DiscontinuityAccount account;
  (void)account.pay(3.0);
  ContactFade fade(0.1, true, true);
  for (int tick = 0; tick < 500; ++tick) (void)fade.step(springAt(2.0), account);
  EXPECT_NEAR(fade.gain(), 0.0, 1e-12);
  for (int tick = 0; tick < 500; ++tick) {
    account.refill();
    (void)fade.step(springAt(2.0), account);
  }
  EXPECT_NEAR(fade.gain(), 0.75, 1e-6);  // 0.75 of 1 mJ
}

TEST(ContactFade, AHaltReleasesTheWholeForce) {
  DiscontinuityAccount account;
  ContactFade fade(0.1, true, true);
  for (int tick = 0; tick < 200; ++tick) (void)fade.step(springAt(2.0), account);
  FadeTick halt = springAt(2.0);
  halt.jump = true;
  halt.touchable = false;
  halt.last_N = halt.last_static_N = {0.0, 0.0, 1.0};
  EXPECT_NE(fade.step(halt, account) & bit(SafetyAction::kResidue), 0U);
  EXPECT_EQ(fade.gain(), 0.0);
  EXPECT_NEAR(fade.residue_N().z(), 0.9, 1e-12);
}

/// Whatever jumps, deepens and comes and goes: the energy that the rendered spring gets without the
/// hand stays within the account.
TEST(ContactFade, NoSequenceAddsMoreThanTheAccountHas) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    DiscontinuityAccount account;
    ContactFade fade(0.1, true, true);
    for (int tick = 0; tick < 200; ++tick) (void)fade.step(springAt(0.0), account);
    double stored_mJ = 0.0;
    double added_mJ = 0.0;
    double depth_mm = 0.0;
    Vec3 last_N = Vec3::Zero();
    for (int tick = 0; tick < 10'000; ++tick) {
      account.refill();
      FadeTick next = springAt(depth_mm);
      if (share(random) < 0.02) {
        depth_mm = share(random) < 0.3 ? 0.0 : 5.0 * share(random);
        next = springAt(depth_mm);
        next.jump = true;
      }
      next.touchable = share(random) < 0.99;
      next.last_N = next.last_static_N = last_N;
      (void)fade.step(next, account);
      const double now_mJ = fade.gain() * next.spring_mJ;
      added_mJ += std::max(0.0, now_mJ - stored_mJ);
      stored_mJ = now_mJ;
      last_N = fade.gain() * next.full_N + fade.residue_N();
      ASSERT_GE(fade.gain(), 0.0);
      ASSERT_LE(fade.gain(), 1.0);
    }
    EXPECT_LE(added_mJ, 3.0 + 1.5 * 10.0 + 1e-6) << seed;
  }
}

}  // namespace
}  // namespace hapticast::client
