// SPDX-License-Identifier: MIT
// The thesis's figures drawn again, its method and ours side by side.
#include "tests/evaluate/figures/figures_parts.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

static void evaluateFigures(const Options& options) {
  Report report("figures", options);
  report.say(
      "The thesis's figures 2, 5, 6, 7 and 9 again: its method (`--method thesis` on both sides) "
      "and "
      "ours, from the same pictures, through the wire; forces at 0.5 N/mm, before the safety chain "
      "(which limits both alike). The rows below: rms of the error over rms of the truth, per "
      "curve.");
  drawPictures(options, report);
  drawSlice(options, report);
  drawMotions(options, report);
  drawRealClip(options, report);
  report.write();
}

const RegisteredTopic kFiguresTopic("figures",
                                    "figures of the thesis again, by its method and by ours",
                                    evaluateFigures);

}  // namespace hapticast::evaluate
