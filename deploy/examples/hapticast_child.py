"""The bytes of --depth-from and --mask-from, which the programs in this folder share. Needs numpy.

The server writes pictures to stdin and reads one answer for each of them from stdout, in the same order.
"""
import json
import os

import numpy as np


def claim_stdout():
    """Returns the stream for answers. From now on all that the process prints goes to stderr.

    Call it before the import of a library that prints.
    """
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return answers


def read_array(stream, shape, kind):
    """Returns an array of this shape and kind; None if the stream ends before that."""
    array = np.empty(shape, kind)
    count = stream.readinto(array.view(np.uint8).reshape(-1))
    return array if count == array.nbytes else None


def read_ppm(stream):
    """Returns the next picture of --depth-from: uint8, height x width x 3 (RGB); None at the end."""
    magic = stream.readline()
    if not magic:
        return None
    if magic != b"P6\n":
        raise ValueError("stdin has no picture (binary PPM)")
    width, height = map(int, stream.readline().split())
    stream.readline()  # the largest value, 255
    return read_array(stream, (height, width, 3), np.uint8)


def write_depth(stream, depth, kind):
    """Answers a picture of --depth-from.

    depth: height x width. It may be smaller than the picture, in the same shape.
    kind: metric_mm; or relative (far is large) or inverse (near is large), which need no unit.
    """
    height, width = depth.shape
    stream.write(f"{width} {height} {kind}\n".encode())
    stream.write(np.ascontiguousarray(depth, "<f4").tobytes())
    stream.flush()


def read_mask_request(stream):
    """Returns the next request of --mask-from; None at the end.

    A request has: a dictionary with frame, time_s, width, height and points (each with object, u, v, time_s; object 0:
    on no object); the picture as read_ppm() returns it; and the depth in mm, float32, height x width (0: not measured).
    """
    line = stream.readline()
    if not line:
        return None
    request = json.loads(line)
    size = (request["height"], request["width"])
    picture = read_array(stream, (*size, 3), np.uint8)
    depth = read_array(stream, size, np.dtype("<f4"))
    return None if depth is None else (request, picture, depth)


def write_mask(stream, mask):
    """Answers a request of --mask-from.

    mask: height x width of the picture; 0, or n for object n. None: no mask for this frame; hapticast tracks by itself.
    """
    height, width = (0, 0) if mask is None else mask.shape
    stream.write(f"{width} {height}\n".encode())
    if mask is not None:
        stream.write(np.ascontiguousarray(mask, np.uint8).tobytes())
    stream.flush()
