// SPDX-License-Identifier: MIT
// Scenes as people record them: a thing, the hands that hold it, the person, table and room around.
// Drawn as a source of frames with exact truth. Thread: one.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/source/rgbd_source.hpp"
#include "tests/scenes/held/hand.hpp"
#include "tests/scenes/held/objects.hpp"
#include "tests/scenes/held/render.hpp"
#include "tests/scenes/held/sensing.hpp"

namespace hapticast::evaluate::held {

/// The names of the things of a scene.
enum Id : std::uint8_t {
  kRoom = 0,
  kObject = 1,
  kHand = 2,
  kOtherHand = 3,
  kPerson = 4,
  kTable = 5,
  kOther = 6
};

/// Where a hand is at a moment, and the object of its pose's frame.
struct Station {
  double time_s = 0.0;
  enum class On : std::uint8_t { kScene, kObject, kProp } on = On::kScene;
  Pose pose;
  double closed = 0.0;      ///< share of its grip
  Vec3 anchor_mm{0, 0, 0};  ///< on::kObject: the place of the unbent thing that it moves with
};

struct HandScript {
  std::uint8_t id = kHand;
  HandLook look;
  Vec3 elbow_mm = Vec3::Zero();  ///< when the hand is at its first station
  double elbow_follows = 0.4;    ///< share of the hand's way
  Curls grip{};
  std::vector<Station> stations;  ///< eased between, as hands move
};

/// Something else that moves.
struct Prop {
  Thing thing;
  Path path;
};

/// All in the camera's frame.
struct Scene {
  std::string name;
  double duration_s = 2.2;
  std::vector<Paint> paints;
  Light light;
  Vec3 middle_mm{0, 0, 700};
  double focal_share = 0.94;  ///< focal length over the picture's width
  std::vector<Thing> room;    ///< what does not move
  Object object;
  std::vector<Prop> props;
  std::vector<HandScript> hands;
  Sensing sensing;
  bool reported_apart = false;  ///< not in the sums of the others
  bool held_at_start = false;   ///< a hand is at the object in the first frame
};

/// One frame's truth.
struct Truth {
  cv::Mat id;             ///< CV_8UC1, Id
  cv::Mat depth;          ///< CV_32FC1, mm, exact
  double whole_px = 0.0;  ///< of the object, if nothing were in its way
  MotionState centre;     ///< of the object's middle (of a tube its line's); camera frame

  [[nodiscard]] cv::Mat mask() const { return id == static_cast<int>(kObject); }
  [[nodiscard]] double visibleShare() const {
    return whole_px > 0 ? cv::countNonZero(mask()) / whole_px : 0.0;
  }
};

/// The hand of a script at a moment.
Thing handOf(const HandScript& script, const Scene& scene, double t);

/// Draws a scene frame by frame.
class Film {
 public:
  Film(const Scene& scene, const cv::Size& size, double fps = 25.0);

  /// The frame as its sensor gives it, and the truth.
  struct Shot {
    server::RgbdFrame frame;
    Truth truth;
  };
  [[nodiscard]] Shot shoot(std::uint64_t index) const;
  [[nodiscard]] const server::SourceInfo& info() const { return info_; }
  [[nodiscard]] const server::CameraModel& camera() const { return renderer_.camera(); }

 private:
  Scene scene_;
  server::SourceInfo info_;
  Renderer renderer_;
  Picture room_;
  Shadows room_shadows_;
};

/// The scenes of one draw: looks, light, places, sensors. Set 1 is what methods are tuned on; its
/// sensors are dealt so that each kind has its turn.
std::vector<Scene> heldScenes(std::uint64_t set);

}  // namespace hapticast::evaluate::held
