# SPDX-License-Identifier: MIT
"""Force and height over a line across the first object of a clip (as figure 5 of the thesis)."""
import sys

import hapticast
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

frame = next(f for f in hapticast.open("synthetic:bounce").frames() if f.objects)
x0, y0, _ = frame.objects[0].position_mm
frames = [hapticast.Frame(i / 25, frame.objects, frame.info["size"]) for i in range(200)]
x = np.r_[np.full(500, -60.0), np.linspace(-60, 60, 6000)]  # 20 mm/s, after half a second at rest
touch = hapticast.Renderer().run(frames, np.c_[x0 + x, np.full_like(x, y0), np.full_like(x, 14.0)])
figure, (force, height) = plt.subplots(2, sharex=True)
force.plot(x, touch.force_N, label=["x", "y", "z"])
height.plot(x, touch.height_mm)
force.set_ylabel("force, N")
force.legend()
height.set_ylabel("height, mm")
height.set_xlabel("x, mm")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "slice.png")
