#!/usr/bin/env python3
"""Masks by SAM 2.1, for --mask-from. Your points (--object, --not) are its clicks.

UNTESTED: no weights can be had where hapticast is made, so this file has never run with the model. It follows the
documentation of the library. tests/child checks the part that all programs share (hapticast_child.py).

Model: SAM 2.1 (September 2024). Its own video predictor (package sam2) needs all frames in advance. The one of
transformers also accepts a stream, frame by frame, and remembers the frames before; this file uses that one.
Licences: code and weights Apache-2.0. Library: transformers 4.56 or later (Apache-2.0), which loads the weights from
huggingface.co at the first start.

  pip install torch torchvision transformers pillow numpy      # torch for your GPU: pytorch.org
  hapticast-server --source VIDEO --mask-from 'python3 sam2.py' --object 320,240

Without points, and before the first of them, hapticast chooses and tracks the object by itself. So it does if this
program starts again in the middle of a clip, where it has no memory.
"""
import argparse
import sys

import hapticast_child

answers = hapticast_child.claim_stdout()

# pylint: disable=wrong-import-position
import torch
from transformers import Sam2VideoModel, Sam2VideoProcessor


def click(processor, session, frame, points, size):
    """Adds points to a frame. A point on no object is one against each object."""
    ids = sorted({point["object"] for point in points} - {0} | set(session.obj_ids))
    own = {each: [point for point in points if point["object"] in (0, each)] for each in ids}
    own = {each: clicks for each, clicks in own.items() if clicks}
    if own:
        processor.add_inputs_to_inference_session(
            session, frame, list(own), original_size=size,
            input_points=[[[[point["u"], point["v"]] for point in clicks] for clicks in own.values()]],
            input_labels=[[[int(point["object"] > 0) for point in clicks] for clicks in own.values()]])
    return bool(own)


def track(processor, model, session, frame, picture, points):
    """Returns the mask of a frame; None as long as no object is known."""
    inputs = processor(images=picture, device=model.device, return_tensors="pt")
    given = {"inference_session": session, "frame": inputs.pixel_values[0], "frame_idx": frame}
    output = model(**given) if session.obj_ids else None
    if points and click(processor, session, frame, points, inputs.original_sizes[0]):
        output = model(**given)  # tracked first, so that clicks correct the mask of an object that is known
    if output is None:
        return None
    session.processed_frames.pop(frame - 1, None)  # all of them would fill the memory
    for outputs in session.output_dict_per_obj.values():
        outputs["non_cond_frame_outputs"].pop(frame - 32, None)  # the model looks back at 16 frames
    scores = processor.post_process_masks([output.pred_masks], inputs.original_sizes, binarize=False)[0][:, 0]
    best = scores.float().max(dim=0)
    ids = torch.tensor(session.obj_ids, device=best.indices.device)
    return torch.where(best.values > 0, ids[best.indices], 0).cpu().numpy()


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--model", default="facebook/sam2.1-hiera-small", help="-tiny, -base-plus, -large")
    flags = options.parse_args()
    device, kind = ("cuda", torch.bfloat16) if torch.cuda.is_available() else ("cpu", torch.float32)
    processor = Sam2VideoProcessor.from_pretrained(flags.model)
    model = Sam2VideoModel.from_pretrained(flags.model).to(device, dtype=kind).eval()
    session = processor.init_video_session(inference_device=device, dtype=kind)
    masks = {}  # the last ones: the server may ask for a frame again
    before_s = None
    while (received := hapticast_child.read_mask_request(sys.stdin.buffer)) is not None:
        request, picture, _ = received
        frame, time_s = request["frame"], request["time_s"]
        if before_s is None:
            before_s = time_s if frame > 0 else -1.0
        if frame not in masks:
            points = [point for point in request["points"] if before_s < point["time_s"] <= time_s]
            masks[frame] = track(processor, model, session, frame, picture, points)
            masks.pop(frame - 16, None)
            before_s = time_s
        hapticast_child.write_mask(answers, masks[frame])


if __name__ == "__main__":
    main()
