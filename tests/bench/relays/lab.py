# SPDX-License-Identifier: MIT
"""Hosts (network namespaces), processes and viewers for measurements of relays.

All hosts are on one network of two bridges. The link between the bridges can be cut: a partition.
"""
import os
import select
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
from programs import Program, start_nats  # pylint: disable=wrong-import-position


class Process(Program):
    """A program with the time of its start and its processor time."""

    def __init__(self, *command, **options):
        self.started_s = time.monotonic()
        super().__init__(*command, **options)

    def cpu_s(self):
        """Returns the processor time of each thread so far."""
        tasks = Path(f"/proc/{self.process.pid}/task").iterdir()
        return {task.name: int((task / "schedstat").read_text().split()[0]) * 1e-9 for task in tasks}


class Lab:
    """Starts processes, on hosts of their own or on loopback. Leaves nothing behind."""

    def __init__(self, build, out):
        self.build = build
        self.out = out
        self.out.mkdir(parents=True, exist_ok=True)
        self.processes = []
        self.prefix = f"hr{os.getpid()}"
        self.hosts = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self.processes:
            process.stop()
        for host in [*self.hosts, "net"]:
            subprocess.run(["ip", "netns", "del", self.prefix + host], stderr=subprocess.DEVNULL)

    def start(self, name, *command, host=None):
        where = ["ip", "netns", "exec", self.prefix + host] if host else []
        process = Process(*where, *command, log=self.out / f"{name}.log")
        self.processes.append(process)
        return process

    def server(self, name, *flags, host=None, listen="127.0.0.1:0"):
        return self.start(name, self.build / "server/hapticast-server", "--listen", listen, *flags, host=host)

    def client(self, name, server, *flags, host=None):
        return self.start(name, self.build / "client/hapticast-client", server, "--device", "virtual",
                          "--hand", "press", "--view", "off", "--fault-dir", self.out, "--summary",
                          self.out / f"{name}.json", *flags, host=host)

    def viewers(self, name, server, count, seconds, host=None):
        return self.start(name, self.build / "tests/hapticast-viewers", "--server", server, "--viewers", count,
                          "--seconds", seconds, "--rounds", 1, host=host)

    def nats(self):
        """Starts a nats-server on loopback. Returns host:port."""
        nats, address = start_nats(log=self.out / "nats.log")
        self.processes.append(nats)
        return address

    # Hosts.

    def ip(self, *command):
        subprocess.run(["ip", *command], check=True)

    def make_network(self):
        probe = subprocess.run(["ip", "netns", "add", self.prefix + "net"], capture_output=True, text=True)
        if probe.returncode != 0:
            raise SystemExit(f"skipped: network namespaces are not permitted here ({probe.stderr.strip()}); be root")
        net = ["-n", self.prefix + "net"]
        for side in "12":
            self.ip(*net, "link", "add", f"bridge{side}", "type", "bridge")
            self.ip(*net, "link", "set", f"bridge{side}", "up")
        self.ip(*net, "link", "add", "between1", "type", "veth", "peer", "name", "between2")
        for side in "12":
            self.ip(*net, "link", "set", f"between{side}", "master", f"bridge{side}", "up")

    def add_host(self, name, side):
        """Returns the address of a new host on side 1 or 2."""
        address = f"10.78.0.{len(self.hosts) + 1}"
        self.hosts[name] = address
        space = self.prefix + name
        self.ip("netns", "add", space)
        self.ip("-n", self.prefix + "net", "link", "add", name, "type", "veth", "peer", "name", "eth0", "netns", space)
        self.ip("-n", self.prefix + "net", "link", "set", name, "master", f"bridge{side}", "up")
        self.ip("-n", space, "addr", "add", address + "/24", "dev", "eth0")
        self.ip("-n", space, "link", "set", "eth0", "up")
        self.ip("-n", space, "link", "set", "lo", "up")
        return address

    def set_link(self, name, up):
        """Sets the link of a host, or with "between1" the link between both sides."""
        self.ip("-n", self.prefix + "net", "link", "set", name, "up" if up else "down")

    def nats_of(self, host):
        """Returns the address of the NATS server that a host is connected to."""
        lines = subprocess.run(["ip", "netns", "exec", self.prefix + host, "ss", "-tnH", "dst", ":4222"],
                               capture_output=True, text=True, check=True).stdout
        return lines.split()[4].split(":")[0]


def _varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at


class Viewer:
    """A viewer by TCP that notes when each frame arrives."""

    def __init__(self, address):
        host, port = address.split(":")
        self.socket = socket.create_connection((host, int(port)))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.data = bytearray()
        self.arrivals_ns = {}  # by frame id
        self.media_ns = {}
        self.pongs = []  # (round trip, media clock less local clock), ns
        self._send(b"\x0a\x0b\x08\x03\x12\x05bench\x20\x01")  # Hello: version 3, frames on TCP

    def _send(self, message):
        self.socket.sendall(struct.pack("<I", len(message)) + message)

    def ping(self):
        self._send(b"\x1a\x09\x09" + struct.pack("<q", time.monotonic_ns()))

    def read(self):
        now_ns = time.monotonic_ns()
        received = self.socket.recv(1 << 20)
        if not received:
            raise RuntimeError("a server has closed the connection of a viewer")
        self.data += received
        while len(self.data) >= 4:
            size = 4 + struct.unpack_from("<I", self.data)[0]
            if len(self.data) < size:
                return
            self._on_message(bytes(self.data[4:size]), now_ns)
            del self.data[:size]

    def _on_message(self, message, now_ns):
        if message[0] == 0x22:  # Pong
            t0_ns, t1_ns, t2_ns = (struct.unpack_from("<q", message, 3 + 9 * i)[0] for i in range(3))
            self.pongs.append((now_ns - t0_ns - (t2_ns - t1_ns), (t1_ns - t0_ns + t2_ns - now_ns) // 2))
        if message[0] != 0x32:  # no HapticFrame
            return
        at = _varint(message, 1)[1]
        if message[at] == 0x08:  # epoch
            at = _varint(message, at + 1)[1]
        frame, at = _varint(message, at + 1)
        self.arrivals_ns.setdefault(frame, now_ns)
        self.media_ns[frame] = struct.unpack_from("<q", message, at + 1)[0]


def watch(viewers, seconds):
    """Lets viewers receive."""
    end = time.monotonic() + seconds
    next_ping = 0
    while (now := time.monotonic()) < end:
        if now >= next_ping:
            next_ping = now + 0.1
            for viewer in viewers:
                viewer.ping()
        for readable in select.select([viewer.socket for viewer in viewers], [], [], min(0.2, end - now))[0]:
            next(viewer for viewer in viewers if viewer.socket is readable).read()


def quantile(values, q):
    values = sorted(values)
    return values[min(len(values) - 1, int(q * len(values)))] if values else float("nan")
