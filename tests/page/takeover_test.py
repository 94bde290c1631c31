# SPDX-License-Identifier: MIT
"""A page at an edge, whose origin dies: the standby takes over, and the page goes on in the same connection."""

import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

import support

SOURCE = ["--source", "synthetic:still", "--loop", "--map-range", "520,620"]


@unittest.skipUnless(shutil.which("nats-server"), "nats-server was not found")
class Takeover(support.PageTest):

    def start_nats(self):
        """Returns the address of a NATS server."""
        folder = tempfile.TemporaryDirectory(prefix="hapticast-nats-")
        self.addCleanup(folder.cleanup)
        log = pathlib.Path(folder.name, "log")
        # pylint: disable-next=consider-using-with
        nats = subprocess.Popen(["nats-server", "-a", "127.0.0.1", "-p", "-1", "-l", str(log)])
        self.addCleanup(nats.wait)
        self.addCleanup(nats.kill)
        pattern = r"Listening for client connections on (\S+)"
        return support.wait_until(lambda: log.exists() and re.search(pattern, log.read_text(encoding="utf-8")),
                                  "nats-server does not start")[1]

    def test_takeover(self):
        channel = f"nats://{self.start_nats()}/page"
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
