# SPDX-License-Identifier: MIT
"""Sessions of the page: a server that stops and returns, a clip's seam, a recording on demand."""

import os
import signal

import support

# Keeps all states, and the magnitude of the force of each tick that the worker reports.
KEEP = """
window.states = [];
window.forces = [];
window.Worker = class extends Worker {
  constructor(...parameters) {
    super(...parameters);
    this.addEventListener('message', ({data}) => {
      if (data.type === 'status') states.push(data.state);
      if (data.type !== 'ticks') return;
      for (let i = 0; i < data.history.length; i += 4) forces.push(data.history[i]);
    });
  }
};
"""
LARGEST_STEP_N = 0.5  # of a tick: the slew limit of a falling force

def record(folder, *arguments):
    """Returns a recording that a server has made."""
    path = os.path.join(folder, "recorded.mcap")
    recorder = support.Server(*arguments, "--record", path)
    try:
        if recorder.process.wait(60) != 0:
            raise AssertionError(recorder.output())
    finally:
        recorder.stop()
    return path


class Reconnection(support.PageTest):

    def press(self):
        at = self.browser.place()
        self.browser.mouse("Moved", at)
        self.browser.press(at)
        self.browser.wait_for_force()

    def check_return(self, second):
        """Stops the server in contact; the page then shows the second one of the same port."""
        first = self.serve(*support.STILL)
        page = self.browser.touchable(first.link)
        key = page.get("hapticast.stream.key")
        self.press()
        first.end(signal.SIGKILL)
        page.wait_for_state("retrying")
        self.assertIn("connects again", page.text("card"))
        page.shoot("retrying")
        page.wait("Math.hypot(...hapticast.report.force_N) === 0", "the force outlives the server")
        page.wait("document.getElementById('force-text').innerText === '0.00 N'", "the page shows an old force")
        self.serve(*second, listen=f"127.0.0.1:{first.port}")
        page.wait_for_state("connected")
        shown = page.get("hapticast.stats.pictures_shown")
        page.wait(f"hapticast.stats.pictures_shown > {shown} + 2", "no pictures after the return")
        page.wait("hapticast.stream.signature === 'signed'", "no signature after the return")
        self.assertNotEqual(page.get("hapticast.stream.key"), key)

    def test_a_restarted_server(self):
        self.check_return(support.STILL)
        self.browser.driver.execute_script("document.getElementById('lift').click()")
        self.browser.wait("hapticast.report.hip_mm[2] > 30", "the tip is not lifted")
        self.press()

    def test_another_stream_on_the_same_port(self):
        self.check_return(["--source", "synthetic:approach", "--loop", "--name", "the other",
                           "--map-range", "440,720"])
        self.assertEqual(self.browser.text("name"), "the other")

    def test_a_server_that_is_held(self):
        """SIGSTOP: the connection stays, but nothing comes."""
        server = self.serve(*support.STILL)
        page = self.browser.touchable(server.link)
        self.press()
        server.process.send_signal(signal.SIGSTOP)
        page.wait("Math.hypot(...hapticast.report.force_N) === 0", "the force outlives the stream")
        page.wait_for_state("retrying")
        server.process.send_signal(signal.SIGCONT)
        page.wait_for_state("connected")
        page.wait("hapticast.report.lookup === 'interpolated'", "the stream does not go on")


class Seam(support.PageTest):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser.command("Page.addScriptToEvaluateOnNewDocument", source=KEEP)

    def test_the_clip_begins_again_under_the_tip(self):
        """2 s of a ball that comes and goes: at the seam it jumps away by 70 mm."""
        clip = record(self.browser.folder.name, "--source", "synthetic:approach", "--frames", "48",
                      "--map-range", "440,720")
        server = self.serve("--source", clip, "--loop")
        page = self.browser.touchable(server.link)
        at = page.place()
        page.mouse("Moved", at)
        page.wheel(at, 28)
        page.wait("forces.some(force_N => force_N > 0.1)", "there is no force")
        began_ms = page.get("hapticast.report.play_ms")
        page.wait(f"hapticast.report.play_ms > {began_ms} + 4000", "play time stands still")
        self.assertEqual({"failed", "retrying"} & set(page.get("states")), set())
        forces_N = page.get("forces")
        self.assertLess(max(abs(b - a) for a, b in zip(forces_N, forces_N[1:])), LARGEST_STEP_N)


class OnDemand(support.PageTest):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        clip = record(cls.browser.folder.name, *support.STILL, "--frames", "150")
        cls.server = cls.serve_all("--source", clip, "--on-demand", "--loop")

    def setUp(self):
        super().setUp()
        self.page = self.browser.touchable(self.server.link)
        self.page.wait("hapticast.stream.timeline", "the page has no time line")

    def change(self, name, value, event="change"):
        self.page.driver.execute_script(
            f"const e = document.getElementById('{name}'); e.value = {value};"
            f"e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('{event}'))")

    def test_the_time_bar_seeks(self):
        self.assertTrue(self.page.is_shown("time"))
        self.assertAlmostEqual(self.page.get("Number(document.getElementById('place').max)"), 5.96, delta=0.2)
        self.change("place", 4.5)
        self.page.wait("Math.abs(hapticast.stream.timeline.position_s - 4.5) < 0.2", "no seek to 4.5 s")
        self.page.wait("document.getElementById('place-text').innerText.startsWith('0:0')", "no place")
        self.page.shoot("on-demand")
        self.page.driver.find_element("id", "flat").click()
        self.page.wait("hapticast.report.lookup === 'interpolated'", "the stream does not go on")

    def test_pause_and_play(self):
        self.page.driver.find_element("id", "pause-button").click()
        self.page.wait("hapticast.stream.timeline.speed === 0", "the server does not pause")
        self.page.wait("document.getElementById('pause-button').innerText === 'play'", "no button to play")
        stands_s = round(self.page.get("hapticast.stream.timeline.position_s"), 1)
        place = "Number(document.getElementById('place').value)"
        self.page.wait(f"Math.abs({place} - {stands_s}) < 0.11", "the time bar is elsewhere")
        self.press()  # a paused recording can be touched
        self.assertAlmostEqual(self.page.get(place), stands_s, delta=0.11)
        self.page.driver.find_element("id", "pause-button").click()
        self.page.wait("hapticast.stream.timeline.speed === 1", "the server does not play")
        self.page.wait(f"Math.abs(Number(document.getElementById('place').value) - {stands_s}) > 0.3", "time stands")

    def press(self):
        at = self.page.place()
        self.page.mouse("Moved", at)
        self.page.press(at)
        self.page.wait_for_force()

    def test_speed(self):
        self.change("speed", "'0.25'")
        self.page.wait("hapticast.stream.timeline.speed === 0.25", "the server does not slow down")
        self.press()

    def test_another_viewer_has_its_own_time(self):
        self.page.driver.find_element("id", "pause-button").click()
        self.page.wait("hapticast.stream.timeline.speed === 0", "the server does not pause")
        first = self.page.driver.current_window_handle
        self.page.driver.switch_to.new_window("tab")
        try:
            self.page.touchable(self.server.link)
            self.assertEqual(self.page.get("hapticast.stream.timeline.speed"), 1)
        finally:
            self.page.driver.close()
            self.page.driver.switch_to.window(first)


if __name__ == "__main__":
    support.main()
