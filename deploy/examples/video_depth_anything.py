#!/usr/bin/env python3
"""Depth by Video Depth Anything in its streaming mode, for --depth-from.

UNTESTED: no weights can be had where hapticast is made, so this file has never run with the model. It follows
run_streaming.py of the repository, commit 4f5ae23 (October 2025). tests/child checks the part that all programs share
(hapticast_child.py).

Model: Video Depth Anything (2025). It remembers the frames before, so it flickers less than one picture at a time. Its
authors call the streaming mode experimental, and less exact than the usual mode, which needs the whole video.
Licences: code Apache-2.0. Weights: Small Apache-2.0; Base and Large CC-BY-NC-4.0 (not for commercial use).

  git clone https://github.com/DepthAnything/Video-Depth-Anything
  pip install -r Video-Depth-Anything/requirements.txt
  cd Video-Depth-Anything && bash get_weights.sh    # into checkpoints/: video_depth_anything_vits.pth
  hapticast-server --source VIDEO --depth-from 'python3 video_depth_anything.py FOLDER/Video-Depth-Anything' \\
      --depth-cache ~/.cache/hapticast

--metric answers in mm, with checkpoints/metric_video_depth_anything_vits.pth; without it, inverse depth.
"""
import argparse
import sys

import hapticast_child

answers = hapticast_child.claim_stdout()

# pylint: disable=wrong-import-position
import torch

SIZES = {"vits": (64, [48, 96, 192, 384]), "vitb": (128, [96, 192, 384, 768]), "vitl": (256, [256, 512, 1024, 1024])}


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("folder", help="the clone of the repository")
    options.add_argument("--encoder", choices=SIZES, default="vits", help="vits: Small, vitb: Base, vitl: Large")
    options.add_argument("--metric", action="store_true")
    options.add_argument("--input-size", type=int, default=518, help="px; smaller is faster")
    flags = options.parse_args()
    sys.path[0] = flags.folder  # instead of this file's folder: this file has the name of their package
    from video_depth_anything.video_depth_stream import VideoDepthAnything  # pylint: disable=import-outside-toplevel
    device = "cuda" if torch.cuda.is_available() else "cpu"
    features, channels = SIZES[flags.encoder]
    model = VideoDepthAnything(encoder=flags.encoder, features=features, out_channels=channels)
    name = ("metric_" if flags.metric else "") + f"video_depth_anything_{flags.encoder}.pth"
    model.load_state_dict(torch.load(f"{flags.folder}/checkpoints/{name}", map_location="cpu"), strict=True)
    model = model.to(device).eval()
    while (picture := hapticast_child.read_ppm(sys.stdin.buffer)) is not None:
        depth = model.infer_video_depth_one(picture, flags.input_size, device, fp32=device == "cpu")
        if flags.metric:
            hapticast_child.write_depth(answers, 1000 * depth, "metric_mm")  # from metres
        else:
            hapticast_child.write_depth(answers, depth, "inverse")


if __name__ == "__main__":
    main()
