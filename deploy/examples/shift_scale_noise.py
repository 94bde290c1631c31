#!/usr/bin/env python3
"""An estimator's errors on true depth, to try --depth-from without a network.

Answers each picture with the depth image of the same number from a folder, after the errors of an estimator of depth:
another scale and shift in each frame, and soft edges. Needs numpy and Pillow (python3-numpy, python3-pil).

  hapticast-server --source CLIP --depth-from 'shift_scale_noise.py CLIP/depth' --object 167,111
"""
import argparse
import pathlib
import sys

import numpy as np
from PIL import Image

import hapticast_child


def blur(image, width):
    """Returns the mean over width x width pixels."""
    padded = np.pad(image, ((width // 2, (width - 1) // 2),) * 2, mode="edge")
    sums = np.pad(padded, ((1, 0), (1, 0))).cumsum(0, dtype=np.float64).cumsum(1)
    box = sums[width:, width:] - sums[:-width, width:] - sums[width:, :-width] + sums[:-width, :-width]
    return (box / width**2).astype(np.float32)


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("folder", type=pathlib.Path, help="depth images of 16 bits in mm")
    options.add_argument("--scale", type=float, default=0.01, help="standard deviation")
    options.add_argument("--shift", type=float, default=0.01, help="standard deviation, of the median depth")
    options.add_argument("--soft-px", type=int, default=15, help="width of an edge; 1: sharp")
    options.add_argument("--kind", choices=["metric_mm", "relative", "inverse"], default="metric_mm")
    options.add_argument("--seed", type=int, default=1)
    flags = options.parse_args()
    answers = hapticast_child.claim_stdout()
    random = np.random.default_rng(flags.seed)
    files = sorted(flags.folder.iterdir())
    numbers = {}  # of the pictures so far: the server may ask again, and a clip may play again
    while (picture := hapticast_child.read_ppm(sys.stdin.buffer)) is not None:
        number = numbers.setdefault(hash(picture.tobytes()), len(numbers))
        depth = np.asarray(Image.open(files[number % len(files)])).astype(np.float32)
        median = np.median(depth[depth > 0])
        depth[depth == 0] = depth.max()  # an estimator has no holes
        depth = blur(depth, flags.soft_px)
        if flags.kind == "inverse":
            depth, median = 1000 / depth, 1000 / median
        depth = depth * (1 + flags.scale * random.standard_normal()) + flags.shift * median * random.standard_normal()
        hapticast_child.write_depth(answers, depth, flags.kind)


if __name__ == "__main__":
    main()
