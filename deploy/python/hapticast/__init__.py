# SPDX-License-Identifier: MIT
"""hapticast: touch a video while it is broadcast.

Stream reads the frames of a server. Renderer computes the force on a hand. Publisher is a server.
Recording reads files of --record. Vision makes frames of images with depth, and open() reads every
source of hapticast-server.

Units: mm, N, kg, s. Nominal frame: origin at the centre of the picture on the plane of height 0,
x to the right, y up, z towards the viewer.
"""

from ._hapticast import (Frame, Object, Publisher, Recording, Renderer, Stream, faults, lookups,
                         safety_actions)

__all__ = ["Frame", "Object", "Publisher", "Recording", "Renderer", "Stream", "Vision", "faults",
           "lookups", "open", "safety_actions"]


def __getattr__(name):
    """Loads Vision and open() at their first use, because they load OpenCV."""
    if name in ("Vision", "Source", "open"):
        from . import _vision

        return getattr(_vision, name)
    raise AttributeError(f"module 'hapticast' has no attribute '{name}'")
