# SPDX-License-Identifier: MIT
"""Floods of pings on NATS, beside the viewers of two edges.

For each flood the table has: frames that a viewer of an edge lost, how much later than at the origin's own port they
arrived, the processor time of the origin, and what a client by UDP rendered.
"""
import itertools
import json
import random
import signal
import socket
import struct
import threading
import time

from costs import behind_ms, start_relays
from lab import Lab, Viewer, quantile, watch

PING = b"\x08\x03\x11" + struct.pack("<q", 1)  # protocol_version 3, t0_ns
FLOOD_s = 8.0


class Flood:
    """Publishes pings at a rate from a thread of its own."""

    def __init__(self, nats, rate_hz, next_reply, payload=PING):
        host, port = nats.split(":")
        self.socket = socket.create_connection((host, int(port)))
        self.socket.sendall(b'CONNECT {"verbose":false,"pedantic":false,"echo":false}\r\n')
        self.rate_hz, self.next_reply, self.payload = rate_hz, next_reply, payload
        self.sent = 0
        self.stopped = False
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        begin_s = time.monotonic()
        while not self.stopped:
            due = int((time.monotonic() - begin_s) * self.rate_hz) - self.sent
            if due > 0:
                count = min(due, 2000)
                self.socket.sendall(b"".join(
                    b"PUB hapticast.bench.pings %s %d\r\n%s\r\n" % (self.next_reply(), len(self.payload), self.payload)
                    for _ in range(count)))
                self.sent += count
            else:
                time.sleep(0.001)

    def stop(self):
        self.stopped = True
        self.thread.join()
        self.socket.close()


def count_up(prefix):
    numbers = itertools.count(random.randrange(1 << 30))
    return lambda: b"%s%x" % (prefix, next(numbers))


def storm_payload():
    """A ping of an old edge: its field 3 was a term without a proof."""
    return PING + b"\x19" + struct.pack("<Q", 1 << 62)


FLOODS = {
    "none": None,
    "10,000/s, answers to the edges' subject": (10_000, lambda: b"hapticast.bench.origin.state", PING),
    "1/s, term 2^62 without a proof": (1, count_up(b"_INBOX.a"), storm_payload()),
    "440,000/s, one inbox": (440_000, lambda: b"_INBOX.flood", PING),
    "440,000/s, an inbox each": (440_000, count_up(b"_INBOX."), PING),
}


def measure_floods(build, out):
    rows = []
    for number, (name, flood) in enumerate(FLOODS.items()):
        with Lab(build, out) as lab:
            nats, origin, edges = start_relays(lab, 2)
            client = lab.client(f"client{number}", edges[1].address(), "--transport", "udp")
            client.wait_for("connected: ")
            direct, through = Viewer(origin.address()), Viewer(edges[0].address())
            watch([direct, through], 4.0)
            begin_ns, used_s = time.monotonic_ns(), sum(origin.cpu_s().values())
            running = Flood(nats, *flood) if flood else None
            watch([direct, through], FLOOD_s)
            used_s = sum(origin.cpu_s().values()) - used_s
            if running:
                running.stop()
            end_ns = time.monotonic_ns()
            watch([direct, through], 1.0)
            client.end(signal.SIGTERM)
            summary = json.loads((out / f"client{number}.json").read_text())
            during = {frame for frame, at_ns in direct.arrivals_ns.items() if begin_ns <= at_ns < end_ns}
            delays_ms = behind_ms(direct, through, begin_ns, end_ns)
            rows.append({"flood": name, "pings/s": round(running.sent / FLOOD_s) if running else 0,
                         "frames": len(during), "lost": len(during - through.arrivals_ns.keys()),
                         "p99_ms": round(quantile(delays_ms, 0.99), 1), "max_ms": round(max(delays_ms), 1),
                         "origin CPU %": round(100 * used_s / FLOOD_s), "UDP client lost": summary["frames"]["lost"],
                         "its way": summary["delivery"]["way"], "its delay ms": round(summary["playout_delay_ms"]),
                         "step excess N": summary["step_excess_max_N"]})
    return rows
