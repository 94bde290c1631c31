// SPDX-License-Identifier: MIT
#include "tests/scenes/held/scene.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::evaluate::held {

namespace {

server::CameraModel selectCamera(const Scene& scene, const cv::Size& size) {
  const double focal_px = scene.focal_share * size.width;
  return {focal_px, focal_px, 0.5 * size.width, 0.5 * size.height};
}

Pose poseOf(const Station& station, const Scene& scene, double t) {
  switch (station.on) {
    case Station::On::kScene:
      return station.pose;
    case Station::On::kProp:
      return scene.props.front().path.at(t).pose * station.pose;
    case Station::On::kObject:
      break;
  }
  const Object& object = scene.object;
  // It keeps its place beside the anchor, which goes with the thing's bending.
  const Pose bent{object.turned(station.anchor_mm, t), object.placed(station.anchor_mm, t)};
  const Pose beside{station.pose.turn, station.pose.at_mm - station.anchor_mm};
  return object.path.at(t).pose * bent * beside;
}

Pose between(const Pose& a, const Pose& b, double share) {
  const Eigen::Quaterniond from(a.turn);
  const Eigen::Quaterniond to(b.turn);
  return {from.slerp(share, to).toRotationMatrix(), a.at_mm + share * (b.at_mm - a.at_mm)};
}

server::SourceInfo describeSource(const Scene& scene, const cv::Size& size, double fps) {
  server::SourceInfo info;
  info.name = scene.name;
  info.width_px = size.width;
  info.height_px = size.height;
  info.fps = fps;
  info.depth_kind =
      scene.sensing.inHeights() ? server::DepthKind::kHeight : server::DepthKind::kMetric;
  info.frame_count = static_cast<std::uint64_t>(std::llround(scene.duration_s * fps));
  // Who records in 8 bits, or estimates depth, knows no camera.
  const bool measured = scene.sensing.kind == DepthSense::kStructured ||
                        scene.sensing.kind == DepthSense::kFlight ||
                        scene.sensing.kind == DepthSense::kExact;
  if (measured) info.camera = selectCamera(scene, size);
  return info;
}

}  // namespace

Thing handOf(const HandScript& script, const Scene& scene, double t) {
  const auto& stations = script.stations;
  std::size_t next = 0;
  while (next < stations.size() && stations[next].time_s <= t) ++next;
  const Station& a = stations[next > 0 ? next - 1 : 0];
  const Station& b = stations[std::min(next, stations.size() - 1)];
  const double share = b.time_s > a.time_s ? Ease{a.time_s, b.time_s}.at(t) : 0.0;
  const Pose pose = between(poseOf(a, scene, t), poseOf(b, scene, t), share);
  const double closed = a.closed + share * (b.closed - a.closed);
  const Vec3 way = pose.at_mm - poseOf(stations.front(), scene, 0.0).at_mm;
  return makeHand(script.id, script.look, pose, between(openHand(), script.grip, closed),
                  script.elbow_mm + script.elbow_follows * way);
}

Film::Film(const Scene& scene, const cv::Size& size, double fps)
    : scene_(scene),
      info_(describeSource(scene, size, fps)),
      renderer_(selectCamera(scene, size), size, scene.light),
      room_(renderer_.empty()),
      room_shadows_(scene.light, scene.middle_mm) {
  for (const Thing& thing : scene_.room) {
    renderer_.draw(thing, scene_.paints, room_);
    if (thing.id != kTable && thing.id != kRoom) room_shadows_.add(thing);
  }
}

Film::Shot Film::shoot(std::uint64_t index) const {
  const double t = static_cast<double>(index) / info_.fps;
  Picture picture = room_.clone();
  Shadows shadows = room_shadows_.clone();
  Shot shot;
  const Thing object = scene_.object.at(t);
  shot.truth.whole_px = renderer_.draw(object, scene_.paints, picture);
  shot.truth.centre = scene_.object.path.at(t);
  shadows.add(object);
  for (const Prop& prop : scene_.props) {
    Thing thing = prop.thing;
    thing.pose = prop.path.at(t).pose;
    renderer_.draw(thing, scene_.paints, picture);
    shadows.add(thing);
  }
  for (const HandScript& script : scene_.hands) {
    const Thing hand = handOf(script, scene_, t);
    renderer_.draw(hand, scene_.paints, picture);
    shadows.add(hand);
  }
  shot.truth.id = picture.id;
  shot.truth.depth = picture.depth;
  const Color gain = gainAt(scene_.sensing, t / scene_.duration_s);
  const Exact exact{renderer_.develop(picture, shadows, gain), picture.depth, picture.blind};
  shot.frame.index = index;
  shot.frame.clip_time_s = t;
  sense(scene_.sensing, exact, renderer_.camera().fx_px, shot.frame);
  return shot;
}

}  // namespace hapticast::evaluate::held
