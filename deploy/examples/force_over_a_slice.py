# SPDX-License-Identifier: MIT
"""Force and height over a line across the first object of a clip (as figure 5 of the thesis)."""
import sys

import hapticast
import matplotlib.pyplot as plt
import numpy as np

seen = next(f for f in hapticast.open("synthetic:bounce").frames() if f.objects).objects[0]
x0, y0, _ = seen.position_mm
rest = hapticast.Object(seen.height_mm, seen.mask, left_px=seen.rect[0], top_px=seen.rect[1])
x = np.linspace(-40, 40, 8000)  # 10 mm/s, 3 mm below the top
hand = np.c_[x0 + x, np.full_like(x, y0), np.full_like(x, seen.height_mm.max() - 3)]
touch = hapticast.Renderer().run([hapticast.Frame(i / 25, [rest]) for i in range(220)], hand)
figure, (force, height) = plt.subplots(2, sharex=True, figsize=(7, 4))
force.plot(x, touch.force_N, label=["x", "y", "z"])
height.plot(x, touch.height_mm)
force.set_ylabel("force, N")
force.legend()
height.set(xlabel="x, mm", ylabel="height, mm")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "slice.png")
