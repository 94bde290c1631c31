// SPDX-License-Identifier: MIT
// The thesis's figures drawn again, its method and ours side by side.
#include "tests/evaluate/figures/figures_parts.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

static void evaluateFigures(const Options& options) {
  Report report("figures", options);
  drawPictures(options);
  drawSlice(options, report);
  drawMotions(options, report);
  drawRealClip(options);
  report.write();
}

const RegisteredTopic kFiguresTopic(
    "figures",
    {.about = "figures of the thesis again, by its method and by ours",
     .method = "Figures 2, 5, 6, 7 and 9 of the thesis by its method (`--method thesis` on both "
               "sides) and by ours, from the same pictures and through the wire. The truth is the "
               "exact force of the scene. The error is its rms over the rms of the truth, at 0.5 "
               "N/mm, before the safety chain, which limits both alike.",
     .evaluate = evaluateFigures,
     .pictures = {
         {"figure_2.png", "figure 2: frame, depth, mask and enhanced depth"},
         {"figure_5.png",
          "figure 5: a slice of the ball with the static force of a tip 1 mm below the surface"},
         {"figure_6.png",
          "figure 6: the ball moves across; left a still cursor, right an accelerated one"},
         {"figure_7.png", "figure 7: the same, the ball moves towards the viewer"},
         {"figure_9.png", "figure 9: the force on a spot of a real clip over time"}}});

}  // namespace hapticast::evaluate
