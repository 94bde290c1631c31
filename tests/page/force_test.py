# SPDX-License-Identifier: MIT
"""Force in the page against the client's own renderer: the same recording and the same readings.

hapticast-force-script writes the messages of a recording with their arrivals, the positions of a
device, and the force that the native renderer computes (force_script.cpp). The core of the page
renders the same in Chromium.
"""

import base64
import os
import pathlib
import subprocess
import tempfile

import support

SCRIPT = os.environ.get("HAPTICAST_FORCE_SCRIPT", "build/release/tests/hapticast-force-script")
LIMIT_N = 1e-6
SECONDS = "6"
HANDS = str(pathlib.Path(__file__).parents[1] / "data" / "typing_hands")
FRICTION = ["--friction", "0.6,0.5", "--stiffness", "0.8", "--texture-depth", "0.3"]
# Clips and flags. Without HAPTICAST_ALL_CLIPS the test renders the first four.
CLIPS = [
    ["synthetic:bounce"],
    ["synthetic:tumble", "--fps", "50"],
    [HANDS, "--object", "167,111", "--to-and-fro"],
    ["synthetic:still", *FRICTION],
    ["synthetic:approach"],
    ["synthetic:still", "--fps", "10"],
    ["synthetic:bounce", "--fps", "60", *FRICTION],
    ["synthetic:tumble", "--stiffness", "2"],
    ["synthetic:approach", "--fps", "100", "--damping", "2"],
    ["synthetic:bounce", "--mass", "0.5"],
    [HANDS, "--object", "167,111", "--stretch", *FRICTION],
    ["synthetic:tumble", "--motion", "none"],
]
# Renders the records of a script (force_script.cpp). Returns the largest difference of a component of the force.
RENDER = """
const [text, done] = arguments;
(async () => {
  const { startCore } = await import('/core.js');
  const core = await startCore(await WebAssembly.compileStreaming(fetch('/core.wasm')));
  core.start([], '');
  core.open(0, false, true);
  core.poll(0);
  core.setControls({ paused: false, staticOn: true, dynamicOn: true, stiffnessFactor: 1, forceFactor: 1, friction: null }, 0);
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  let at = 0, worst = 0, ticks = 0, touched = 0, equal = 0;
  const number = () => view.getFloat64((at += 8) - 8, true);
  while (at < bytes.length) {
    if (bytes[at++] === 1) {
      const time = number(), size = view.getUint32(at, true);
      const message = core.receive(bytes.subarray(at + 4, at + 4 + size), time);
      if (message.kind === 'error') throw new Error(core.close(time).text);
      at += 4 + size;
      while (core.e.prepare(time));
    } else {
      const time = number(), position = [number(), number(), number()], force = [number(), number(), number()];
      while (core.e.prepare(time));
      core.e.tickAt(time, ...position);
      core.poll(time);  // its pings are those of the script
      const report = core.report(time);
      const difference = Math.max(...force.map((each, i) => Math.abs(each - report.force_N[i])));
      if (Number.isNaN(difference)) throw new Error('a force is no number');
      worst = Math.max(worst, difference);
      ++ticks;
      touched += force.some((each) => each !== 0);
      equal += difference === 0;
    }
  }
  return { worst, ticks, touched, equal };
})().then(done, (error) => done({ error: String(error) }));
"""


class Force(support.PageTest):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server = cls.serve_all(*support.STILL)
        cls.browser.open(cls.server.link)
        cls.browser.driver.set_script_timeout(120)

    def setUp(self):
        pass  # one page for all clips

    def render(self, number, clip):
        """Returns what RENDER returns for a clip."""
        with tempfile.TemporaryDirectory(prefix="hapticast-force-") as folder:
            recording, script = (str(pathlib.Path(folder, name)) for name in ("clip.mcap", "script"))
            subprocess.run([support.SERVER, "bake", *clip, "--frames", "60", "--quiet", "-o", recording], check=True)
            subprocess.run([SCRIPT, recording, script, SECONDS, str(number)], check=True, stdout=subprocess.DEVNULL)
            text = base64.b64encode(pathlib.Path(script).read_bytes()).decode()
        return self.browser.driver.execute_async_script(RENDER, text)

    def test_force(self):
        clips = CLIPS if os.environ.get("HAPTICAST_ALL_CLIPS") else CLIPS[:4]
        for number, clip in enumerate(clips):
            with self.subTest(clip=clip):
                found = self.render(number, clip)
                self.assertNotIn("error", found)
                print(f"{' '.join(clip)}: {found['worst']:.1e} N; {found['equal']} of {found['ticks']} ticks are equal, "
                      f"{found['touched']} have a force", flush=True)
                self.assertGreater(found["touched"], 200)
                self.assertLess(found["worst"], LIMIT_N)


if __name__ == "__main__":
    support.main()
