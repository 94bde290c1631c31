// SPDX-License-Identifier: MIT
// The force through bad networks, by each transport; clocks and playout; what the chain makes of
// it all.
#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/network/network_parts.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/evaluate/touch/touch_hands.hpp"

namespace hapticast::evaluate {

testing::LinkProfile farLink(Duration jitter) {
  testing::LinkProfile link;
  link.delay = std::chrono::milliseconds(20);
  link.jitter = jitter;
  return link;
}

std::vector<NetworkScene> networkScenes(double seconds) {
  struct Touched {
    TouchScene scene;
    Hand hand;
  };
  std::vector<Touched> touched;
  const auto slide = [&](TouchScene scene, double reach_mm) {
    Hand hand = slidingHand(scene, reach_mm);
    touched.push_back({std::move(scene), std::move(hand)});
  };
  slide(movingSphere(10.0, seconds), 8.0);
  slide(breathingDome(seconds), 10.0);
  slide(spinningEllipsoid(seconds), 10.0);
  TouchScene plate = swingingPlate(seconds);
  touched.push_back({plate, holdingHand(plate, {3.0, 2.0}, 1.0)});
  std::vector<std::optional<NetworkScene>> made(touched.size());
  onAllCores(made.size(), [&](std::size_t i) {
    StreamKind kind;
    kind.slices = SliceSettings{};
    made[i] = NetworkScene{touched[i].scene.name, SentStream(makeStream(touched[i].scene, kind)),
                           touched[i].hand};
  });
  std::vector<NetworkScene> scenes;
  scenes.reserve(made.size());
  for (std::optional<NetworkScene>& each : made) scenes.push_back(std::move(*each));
  return scenes;
}

static void evaluateNetwork(const Options& options) {
  Report report("network", options);
  const double seconds = options.quick ? 12.0 : 30.0;
  const std::vector<NetworkScene> scenes = networkScenes(seconds + 1.0);
  const auto wanted = [&](const char* part) {
    return options.only.empty() || options.only == part;
  };
  if (wanted("force")) networkForce(scenes, seconds, options, report);
  if (wanted("safety")) networkSafety(scenes, options, report);
  if (wanted("clocks")) networkClocks(scenes.front(), seconds, report);
  report.write();
}

const RegisteredTopic kNetworkTopic(
    "network",
    {.about =
         "the force through loss, jitter and cuts, by each transport; clocks; about ten minutes",
     .method = "A server, a network and a viewer in virtual time. The frames of the real server go "
               "as datagrams or over TCP, through a link each way, to the client's own receiver, "
               "loss meter, playout clock and look-up, and a scripted hand feels them. The truth "
               "is the same run without loss and jitter, and the true clock. Frames have 0.3 to "
               "2.4 KB in 1 to 5 datagrams, 25 a second.",
     .evaluate = evaluateNetwork,
     .pictures = {
         {"network.png", "what loss adds to the error of the force, and what it costs in delay"}}});

}  // namespace hapticast::evaluate
