# SPDX-License-Identifier: MIT
"""How tests and measurements in Python start programs, read their lines and end them.

HAPTICAST_SERVER and HAPTICAST_CLIENT are the programs."""

import os
import pathlib
import re
import signal
import subprocess
import tempfile

from waiting import SOON_S, wait_until

SERVER = os.environ.get("HAPTICAST_SERVER", "build/release/server/hapticast-server")
CLIENT = os.environ.get("HAPTICAST_CLIENT", "build/release/client/hapticast-client")


class Program:
    """A program whose output goes to the file `log`; without one to a file that stop() removes."""

    def __init__(self, *command, log=None, **options):
        self.folder = None if log else tempfile.TemporaryDirectory(prefix="hapticast-program-")
        self.log = pathlib.Path(log or pathlib.Path(self.folder.name, "log"))
        with self.log.open("w", encoding="utf-8") as out:
            # pylint: disable-next=consider-using-with
            self.process = subprocess.Popen([*map(str, command)], stdout=out, stderr=out, **options)

    def output(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def wait_for(self, pattern):
        """Returns the first group (or the text) of `pattern` in the output, unless the program ends before."""
        def find():
            has_ended = self.process.poll() is not None
            found = re.search(pattern, self.output())
            if not found and has_ended:
                raise AssertionError(f"{self.process.args[0]} has ended: {self.output()}")
            return found
        found = wait_until(find, lambda: f"no '{pattern}' in: {self.output()}")
        return found[1] if found.re.groups else found[0]

    def address(self):
        """Returns HOST:PORT where a server listens."""
        return self.wait_for(r"listening on ([^;\s]+)")

    def end(self, number=signal.SIGINT):
        """Ends the program by a signal. Returns its exit code."""
        self.process.send_signal(number)
        return self.process.wait(SOON_S)

    def stop(self):
        """Ends the program at once."""
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        if self.folder:
            self.folder.cleanup()


def start_nats(**options):
    """Starts a nats-server on loopback. Returns the program and HOST:PORT."""
    nats = Program("nats-server", "-a", "127.0.0.1", "-p", -1, **options)
    return nats, nats.wait_for(r"Listening for client connections on (\S+)")
