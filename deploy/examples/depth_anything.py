#!/usr/bin/env python3
"""Depth by Depth Anything V2, for --depth-from.

UNTESTED: no weights can be had where hapticast is made, so this file has never run with the model. It follows the
documentation of the library. tests/child checks the part that all programs share (hapticast_child.py).

Model: Depth Anything V2 (2024), one picture at a time, so a video flickers. hapticast aligns the frames.
Licences: code Apache-2.0. Weights: Small Apache-2.0; Base and Large CC-BY-NC-4.0 (not for commercial use). The pages of
the models Metric-Indoor and Metric-Outdoor state no licence: look at that of their base model.
Library: transformers 4.47 or later (Apache-2.0), which loads the weights from huggingface.co at the first start.

  pip install torch transformers pillow numpy      # torch for your GPU: pytorch.org
  hapticast-server --source VIDEO --depth-from 'python3 depth_anything.py' --depth-cache ~/.cache/hapticast

The usual models answer with inverse depth; --depth-range states the depths of their nearest and farthest parts. The
metric ones answer in mm: --model depth-anything/Depth-Anything-V2-Metric-Indoor-Small-hf
"""
import argparse
import sys

import hapticast_child

answers = hapticast_child.claim_stdout()

# pylint: disable=wrong-import-position
import torch
from transformers import AutoImageProcessor, AutoModelForDepthEstimation


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--model", default="depth-anything/Depth-Anything-V2-Small-hf")
    options.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    flags = options.parse_args()
    processor = AutoImageProcessor.from_pretrained(flags.model)
    model = AutoModelForDepthEstimation.from_pretrained(flags.model).to(flags.device).eval()
    is_metric = model.config.depth_estimation_type == "metric"
    while (picture := hapticast_child.read_ppm(sys.stdin.buffer)) is not None:
        inputs = processor(images=picture, return_tensors="pt").to(flags.device)
        with torch.inference_mode():
            outputs = model(**inputs)
        result = processor.post_process_depth_estimation(outputs, target_sizes=[picture.shape[:2]])[0]
        depth = result["predicted_depth"].float().cpu().numpy()
        if is_metric:
            hapticast_child.write_depth(answers, 1000 * depth, "metric_mm")  # from metres
        else:
            hapticast_child.write_depth(answers, depth, "inverse")


if __name__ == "__main__":
    main()
