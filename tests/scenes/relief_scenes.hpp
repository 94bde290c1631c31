// SPDX-License-Identifier: MIT
// Bodies whose exact surface measures the error of a force, each as a relief scene. Nominal mm.
#pragma once

#include <functional>
#include <vector>

#include "server/source/synthetic/synthetic_scene.hpp"
#include "tests/scenes/relief_scene.hpp"

namespace hapticast::evaluate {

TouchScene stillSphere();     ///< R 20, seen down to its equator
TouchScene stillEllipsoid();  ///< semi-axes 26, 18, 15
TouchScene stillSinusoid();   ///< 1 mm high, 16 mm long, on a disc
/// R 15, to and fro in x, at most this fast; as far as the picture allows.
TouchScene movingSphere(double px_per_frame, double duration_s = 12.0);
/// R 20, to and fro by `amplitude_mm`, `rate_Hz` times a second.
TouchScene swingingSphere(const Vec3& amplitude_mm, double rate_Hz);
/// An ellipsoid that turns about the viewing axis.
TouchScene spinningEllipsoid(double duration_s = 8.0);
/// R 20, in x at one speed, or (0) a plate.
TouchScene steadySphere(double px_per_frame);
/// A flat disc, up and down by 5 mm, once a second.
TouchScene swingingPlate(double duration_s = 6.0);
/// A dome whose height swings by 2 mm, once a second.
TouchScene breathingDome(double duration_s = 6.0);
/// A box that comes to a place and goes again, 10 px/frame where it touches.
TouchScene drivenBox();
/// A flat disc at rest.
TouchScene stillPlate();
/// A ball that bounces on a floor: `gravity` down in y, from floor to floor in `flight_s`.
TouchScene bouncingBall(double gravity_mm_s2, double flight_s, double first_s);
std::vector<double> impactsOf(double flight_s, double first_s, double duration_s);

/// The server's own scene before a pinhole camera, its depth in 8 bits (or not).
TouchScene syntheticScene(server::SceneKind kind);

/// A side wall, from above: where it is and which way is out.
struct Wall {
  TouchScene scene;
  struct Point {
    Vec2 at_mm;
    Vec2 outward;
  };
  std::function<Point(double along_mm)> at;
  double push_z_mm = 0.0;  ///< height at which the hand pushes: between the floor and the top
  double reach_mm = 6.0;   ///< the hand goes this far along it, to and fro
  HeightAt top_mm;         ///< of what is pushed, continued beyond its edge
};
Wall boxWall(double top_slope = 0.0);  ///< turned by 17 degrees
Wall cylinderWall();                   ///< R 15
Wall stepWall();                       ///< 10 mm inside an object, turned by 17 degrees

}  // namespace hapticast::evaluate
