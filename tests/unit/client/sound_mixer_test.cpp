// SPDX-License-Identifier: MIT
// The sound of a force, sample by sample.
#include "client/view/sound_mixer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticast::client {
namespace {

class SoundMixerTest : public ::testing::Test {
 protected:
  /// The loudest sample of so many buffers under this force; `news`: the mixer receives it.
  double listen(int buffers, const ForceComponents& trace, bool news = true) {
    double loudest = 0.0;
    for (int i = 0; i < buffers; ++i) {
      std::vector<float> samples(512);
      if (news) ++tick_;
      mixer_.fill(samples, {.force = trace, .tick = tick_, .beeps = beeps});
      for (const float sample : samples) {
        loudest = std::max(loudest, std::abs(double{sample}));
        largest_step = std::max(largest_step, std::abs(double{sample} - last_));
        last_ = double{sample};
      }
    }
    return loudest;
  }
  double largest_step = 0.0;
  std::uint32_t beeps = 0;

 private:
  SoundMixer mixer_;
  std::uint64_t tick_ = 0;
  double last_ = 0.0;
};

TEST_F(SoundMixerTest, IsSilentWithoutContact) {
  EXPECT_EQ(listen(100, {}), 0.0);
  EXPECT_EQ(listen(100, {.sustained_N = 0.04, .transient_N = 0.04}), 0.0) << "hardly felt";
}

TEST_F(SoundMixerTest, IsLouderTheStrongerTheForceIsAndNeverTooLoud) {
  double last = 0.0;
  for (const double sustained_N : {0.2, 0.5, 1.0, 1.5, 2.0}) {
    (void)listen(20, {.sustained_N = sustained_N});
    const double now = listen(20, {.sustained_N = sustained_N});
    EXPECT_GT(now, 1.2 * last) << sustained_N;
    last = now;
  }
  EXPECT_NEAR(last, 0.5 * SoundMixer::kLoudest, 0.01);
  EXPECT_LE(listen(100, {.sustained_N = 1e9, .transient_N = 1e9}), SoundMixer::kLoudest);
}

TEST_F(SoundMixerTest, ABlowIsAudibleBesideAPress) {
  (void)listen(20, {.sustained_N = 1.0});
  const double press = listen(20, {.sustained_N = 1.0});
  EXPECT_GT(listen(2, {.sustained_N = 1.0, .transient_N = 1.0}), 1.5 * press);
  (void)listen(10, {.sustained_N = 1.0});
  EXPECT_NEAR(listen(20, {.sustained_N = 1.0}), press, 0.01);
}

TEST_F(SoundMixerTest, ABeepIsShortAndNeedsNoForce) {
  ++beeps;
  EXPECT_NEAR(listen(10, {}, false), 0.5 * SoundMixer::kLoudest, 0.01);
  (void)listen(10, {}, false);  // 0.15 s of beep are over
  EXPECT_LT(listen(10, {}, false), 0.001);
  ++beeps;
  EXPECT_LE(listen(10, {.sustained_N = 1e9, .transient_N = 1e9}), SoundMixer::kLoudest);
  EXPECT_LT(largest_step, 0.2);
}

TEST_F(SoundMixerTest, NoChangeOfTheForceIsAStep) {
  for (int i = 0; i < 200; ++i)
    (void)listen(1 + i % 3, i % 2 == 0 ? ForceComponents{.sustained_N = 2.0, .transient_N = 2.0}
                                       : ForceComponents{});
  // A sample changes by no more than both waves at their loudest do, and by the begin of a blow.
  EXPECT_LT(largest_step, 0.05);
  EXPECT_GT(largest_step, 0.02) << "it was loud";
}

TEST_F(SoundMixerTest, FadesWithoutNewForces) {
  (void)listen(20, {.sustained_N = 2.0});
  EXPECT_GT(listen(5, {.sustained_N = 2.0}, /*news=*/false), 0.2) << "a moment";
  (void)listen(20, {.sustained_N = 2.0}, /*news=*/false);
  EXPECT_LT(listen(20, {.sustained_N = 2.0}, /*news=*/false), 1e-4);
  EXPECT_LT(largest_step, 0.05);
  (void)listen(20, {.sustained_N = 2.0});
  EXPECT_GT(listen(20, {.sustained_N = 2.0}), 0.2) << "it is back";
}

}  // namespace
}  // namespace hapticast::client
