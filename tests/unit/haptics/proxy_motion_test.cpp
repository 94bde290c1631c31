// SPDX-License-Identifier: MIT
// The proxy on what moves: no contact is lost. Contact and error on a ball in motion, a plane that
// swings and a dome that breathes are measured by hapticast-evaluate accuracy.
#include <gtest/gtest.h>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

/// Keeps the fields of a film by where their object is.
class Fields {
 public:
  using Make = std::function<std::shared_ptr<const HeightField>(double t_s)>;
  explicit Fields(Make make) : make_(std::move(make)) {}
  const HeightField* at(double t_s) {
    all_.push_back(make_(t_s));
    return all_.back().get();
  }

 private:
  Make make_;
  std::vector<std::shared_ptr<const HeightField>> all_;
};

class DrivenBox : public ::testing::TestWithParam<double> {};

TEST_P(DrivenBox, PushesAStillHandAsideWithoutLiftingIt) {
  const double speed = GetParam() * 0.25 * 25.0;
  const double slant = 17.0 * M_PI / 180.0;
  const Vec3 direction(std::cos(slant), std::sin(slant), 0.0);
  // Its right wall starts 6 mm short of the hand and ends 2.5 mm behind it.
  const double still_s = 8.5 / speed;
  const auto centre = [=](double t) -> Vec3 {
    return direction * (-16.0 + speed * std::min(t, still_s));
  };
  Fields fields([&](double t) {
    const Vec2 at = centre(t).head<2>();
    const auto box = [=](const Vec2& p) {
      return (Eigen::Rotation2Dd(-slant) * (p - at)).cwiseAbs().maxCoeff() < 10.0;
    };
    return makeField({120, 80, 400, 320}, kWorkspace, level(12.0), box);
  });
  Film film([&](double t) {
    const double v = t < still_s ? speed : 0.0;
    return std::vector{makeObject(1, fields.at(t), centre(t), v * direction)};
  });
  Contact contact;
  double up = 0.0;
  double step = 0.0;
  double before = 0.0;
  Error error;
  for (int i = 0; 1e-3 * i < still_s + 0.1; ++i) {
    contact = film.touch({0.0, 0.0, 5.0});
    const double depth = std::max(0.0, centre(std::min(1e-3 * i, still_s)).dot(direction) + 10.0);
    up = std::max(up, std::abs(contact.displacement_mm.z()));
    step = std::max(step, std::abs(contact.displacement_mm.norm() - before) - speed * 1e-3);
    before = contact.displacement_mm.norm();
    // While it brakes within one frame the film knows less than the truth.
    const bool braking = std::abs(1e-3 * i - still_s) < 0.045;
    if (depth > 0.2 && !braking) error.add(contact.displacement_mm, depth * direction);
  }
  EXPECT_EQ(up, 0.0);
  EXPECT_LT(error.relative(), 0.04);
  EXPECT_LT(step, 0.05);
  EXPECT_NEAR(contact.displacement_mm.dot(direction), 2.5, 0.06);
}

INSTANTIATE_TEST_SUITE_P(Proxy, DrivenBox, ::testing::Values(2.0, 10.0, 40.0));

TEST(ProxyMotion, TurnsWithTheObject) {
  // A tilted, bent box turns a quarter in every 5 frames about a point beside it; the hand rides.
  const Vec2 pivot(3.0, -2.0);
  const double rate = 0.5 * M_PI / 0.2;
  const auto own = [&](const Vec2& at, double t) -> Vec2 {
    return Eigen::Rotation2Dd(-rate * t) * (at - pivot);
  };
  const auto height = [](const Vec2& q) {
    return 12.0 + 0.3 * q.x() - 0.01 * q.squaredNorm() + 0.1 * q.y();
  };
  Fields fields([&](double t) {
    return makeField(
        {240, 160, 160, 160}, kWorkspace, [=](const Vec2& at) { return height(own(at, t)); },
        [=](const Vec2& at) { return own(at, t).cwiseAbs().maxCoeff() < 12.0; });
  });
  Film film([&](double t) {
    PlayObject object = makeObject(1, fields.at(t), {pivot.x(), pivot.y(), 12.0});
    object.motion.angle_rad = std::remainder(rate * t, 2.0 * M_PI);
    object.motion.angular_velocity_rad_s = rate;
    return std::vector{object};
  });
  Vec3 first = Vec3::Zero();
  for (int i = 0; i < 700; ++i) {
    const double t = 1e-3 * i;
    const Vec2 q(6.0, 4.0);
    const Vec2 at = pivot + Eigen::Rotation2Dd(rate * t) * q;
    const double above = std::max(-0.8, 1.0 - 0.02 * i);
    const Contact contact = film.touch({at.x(), at.y(), height(q) + above});
    if (i < 150) continue;
    ASSERT_TRUE(contact.contact);
    ASSERT_FALSE(contact.jump);
    // The same force in the object's own frame, tick by tick and over frames.
    Vec3 turned = contact.displacement_mm;
    turned.head<2>() = Eigen::Rotation2Dd(-rate * t) * turned.head<2>();
    if (i == 150) first = turned;
    ASSERT_LT((turned - first).norm(), 0.01) << i;
    const Vec2 velocity = rate * Vec2(-(at - pivot).y(), (at - pivot).x());
    ASSERT_LT((contact.surface_velocity_mm_s.head<2>() - velocity).norm(), 0.2 * velocity.norm());
  }
  EXPECT_GT(first.norm(), 0.5);
}

TEST(ProxyMotion, AStickingFingerIsCarriedAlong) {
  const double speed = 40.0;
  const auto centre = [=](double t) { return Vec3(speed * t - 10.0, 0.0, 10.0); };
  Fields fields([&](double t) {
    const Vec2 at = centre(t).head<2>();
    return makeField({120, 160, 400, 160}, kWorkspace, level(10.0),
                     [=](const Vec2& p) { return (p - at).cwiseAbs().maxCoeff() < 15.0; });
  });
  for (const double mu : {0.0, 0.8}) {
    Film film([&](double t) {
      PlayObject object = makeObject(1, fields.at(t), centre(t), {speed, 0.0, 0.0});
      object.material.static_friction = object.material.dynamic_friction = mu;
      return std::vector{object};
    });
    Contact contact;
    for (int i = 0; i < 300; ++i) contact = film.touch({0.0, 0.0, 11.0 - std::min(0.02 * i, 2.0)});
    EXPECT_NEAR(contact.displacement_mm.x(), mu * 1.0, 0.02);  // drawn along, slipping
    EXPECT_NEAR(contact.surface_velocity_mm_s.x(), speed, 1e-6);
  }
}

// --- the residual
// ---------------------------------------------------------------------------------------------------

TEST(ProxyMotion, BlendsAndReportsChangesOfShape) {
  // Rises by 0.5 mm per frame although the pose says it stands.
  const auto height = [](double t) { return 8.0 + 12.5 * t; };
  Fields fields([&](double t) {
    return makeField({280, 200, 80, 80}, kWorkspace, level(height(t)), anywhere);
  });
  Film film([&](double t) { return std::vector{makeObject(1, fields.at(t), Vec3::Zero())}; });
  for (int i = 0; i < 400; ++i) {
    const Contact contact = film.touch({0.0, 0.0, 10.0});
    const double depth = height(1e-3 * i) - 10.0;
    if (depth < 0.02) continue;
    ASSERT_NEAR(contact.displacement_mm.z(), depth, 0.002) << i;
    ASSERT_NEAR(contact.surface_velocity_mm_s.z(), 12.5, 0.01) << i;
  }
}

TEST(ProxyMotion, ReportsAGrowingWallAsMovingOutwards) {
  const auto edge = [](double t) { return 5.0 + 12.5 * t; };
  Fields fields([&](double t) {
    return makeField({240, 160, 200, 160}, kWorkspace, level(12.0),
                     [=](const Vec2& at) { return at.x() < edge(t); });
  });
  Film film([&](double t) { return std::vector{makeObject(1, fields.at(t), Vec3::Zero())}; });
  Contact contact;
  for (int i = 0; i < 300; ++i) contact = film.touch({8.0, 0.0, 5.0});
  EXPECT_NEAR(contact.displacement_mm.x(), edge(0.299) - 8.0, 0.15);  // whole pixels
  EXPECT_EQ(contact.displacement_mm.z(), 0.0);
  EXPECT_NEAR(contact.surface_velocity_mm_s.x(), 12.5, 4.0);
}

}  // namespace
}  // namespace hapticast::client
