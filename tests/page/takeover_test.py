# SPDX-License-Identifier: MIT
"""A page at an edge, whose origin dies: the standby takes over, and the page goes on in the same connection."""

import shutil
import signal
import unittest

import support
from programs import start_nats

SOURCE = ["--source", "synthetic:still", "--loop", "--map-range", "520,620"]


@unittest.skipUnless(shutil.which("nats-server"), "nats-server was not found")
class Takeover(support.PageTest):

    def test_takeover(self):
        nats, address = start_nats()
        self.addCleanup(nats.stop)
        channel = f"nats://{address}/page"
        origin = self.serve(*SOURCE, "--publish", channel)
        origin.wait_for("streaming")
        standby = self.serve(*SOURCE, "--publish", channel)
        edge = self.serve("--source", channel)
        edge.wait_for("streaming")
        page = self.browser.touchable(edge.link)
        key = page.get("hapticast.stream.key")
        at = page.place()
        page.mouse("Moved", at)
        page.press(at)
        page.wait_for_force()
        page.driver.execute_script(
            "window.seen = [];"
            "window.contradictions = [];"
            "setInterval(() => {"
            "  if (seen.at(-1) !== hapticast.status.state) seen.push(hapticast.status.state);"
            "  const {lookup, advice} = hapticast.report;"
            "  if (lookup !== 'faded' && advice.includes('no fresh frames')) contradictions.push([lookup, advice]);"
            "}, 5)")
        origin.end(signal.SIGKILL)
        page.wait(f"hapticast.stream.key !== '{key}' && hapticast.stream.signature === 'signed'",
                  "no frame of the standby")
        page.wait("hapticast.report.lookup === 'interpolated'", "the standby's frames are not played")
        self.assertIn("lift the tip", page.wait("hapticast.report.advice", "no advice"))
        page.wheel(at, -support.DEEP)  # no force on a tip that is inside, until it has left the object
        page.wait("!hapticast.report.advice.includes('below')", "the tip is not lifted")
        page.press(at)
        page.wait_for_force()
        self.assertEqual(page.get("seen"), ["connected"], standby.output())
        self.assertEqual(page.get("contradictions"), [], "a sentence contradicts the numbers of its report")


if __name__ == "__main__":
    support.main()
