# SPDX-License-Identifier: MIT
"""A server, an edge or a client that stands still (SIGSTOP), as a hand in contact perceives it.

For each stop the table has: the time after its end until the force is back, and how much longer the playout delay is
two frame intervals and two seconds later. The hand rests on the ball of synthetic:still (--hand follow).
"""
import csv
import json
import signal
import time

from lab import Lab

STEADY_s = 6.0  # before the stop: the delay has adapted to the link
AFTER_s = 4.0
INTERVAL_s = 0.04
STOPS_s = (0.3, 0.8, 1.5, 3.0, 10.0)


def read_log(file):
    """Returns (time, media time, magnitude of the force) of each tick, s and N."""
    with open(file) as log:
        return [(float(row["t_s"]), float(row["media_s"]), sum(float(row[f"f{axis}_N"]) ** 2 for axis in "xyz") ** 0.5)
                for row in csv.DictReader(log)]


def evaluate(rows, from_stop_to_end_s, stop_s):
    """Returns the time until the force is back, and the increase of the delay at two times after the stop, s.

    The log has its own clock. The force ramps to zero when the client ends, so its last full force is that moment.
    """
    steady_N = sorted(row[2] for row in rows)[9 * len(rows) // 10]
    client_end_s = next(row[0] for row in reversed(rows) if row[2] > 0.5 * steady_N)
    begin_s = client_end_s - from_stop_to_end_s
    rows = [row for row in rows if row[0] <= client_end_s]
    before = [row for row in rows if begin_s - 1.0 < row[0] < begin_s]
    usual_N = sum(row[2] for row in before) / len(before)
    usual_s = sum(row[0] - row[1] for row in before) / len(before)
    after = [row for row in rows if row[0] > begin_s + stop_s]
    lost_s = next((row[0] for row in rows if row[0] > begin_s and row[2] < 0.1 * usual_N), None)
    back_s = 0.0 if lost_s is None else next((row[0] - begin_s - stop_s for row in after
                                              if row[0] > lost_s and row[2] > 0.5 * usual_N), float("nan"))
    delays_s = [next((row[0] - row[1] - usual_s for row in after if row[0] > begin_s + stop_s + wait_s), float("nan"))
                for wait_s in (2 * INTERVAL_s, 2.0)]
    return back_s, delays_s


def run(lab, name, stopped, transport, stop_s):
    """Returns the row of one stop. `stopped`: server, edge or client."""
    log = lab.out / f"{name}.csv"
    flags = ["--source", "synthetic:still", "--loop"]
    if stopped == "edge":
        channel = f"nats://{lab.nats()}/stall"
        flags += ["--publish", channel]
    server = lab.server(f"{name}.server", *flags)
    serving = lab.server(f"{name}.edge", "--source", channel) if stopped == "edge" else server
    host, port = serving.address()
    client = lab.start(f"{name}.client", lab.build / "client/hapticast-client", f"{host}:{port}", "--device", "virtual",
                       "--hand", "follow", "--view", "off", "--fault-dir", lab.out, "--log", log, "--transport", transport,
                       "--summary", lab.out / f"{name}.json")
    client.wait_for("connected: ")
    time.sleep(STEADY_s)
    process = {"server": server, "edge": serving, "client": client}[stopped]
    begin_s = time.monotonic()
    process.send(signal.SIGSTOP)
    time.sleep(stop_s)
    process.send(signal.SIGCONT)
    stopped_s = time.monotonic() - begin_s
    time.sleep(AFTER_s + (2.0 if stop_s > 2.0 else 0.0))
    end_s = time.monotonic()
    client.finish()
    for each in {serving.popen.pid: serving, server.popen.pid: server}.values():
        each.finish()
    excess_N = json.loads((lab.out / f"{name}.json").read_text())["step_excess_max_N"]
    back_s, delays_s = evaluate(read_log(log), end_s - begin_s, stopped_s)
    return {"stopped": stopped, "transport": transport, "stop s": stop_s, "force back after s": f"{back_s:.2f}",
            "delay +2 frames ms": f"{1e3 * delays_s[0]:.0f}", "delay +2 s ms": f"{1e3 * delays_s[1]:.0f}",
            "step excess N": f"{excess_N:.3f}"}


def run_stalls(build, out):
    """Returns a row for each stop of a server, an edge and a client, by UDP and by TCP."""
    stops = [(stopped, transport, stop_s) for stopped in ("server", "edge") for transport in ("udp", "tcp")
             for stop_s in STOPS_s]
    stops += [("client", transport, 4.0) for transport in ("udp", "tcp")]
    rows = []
    for stopped, transport, stop_s in stops:
        with Lab(build, out) as lab:
            rows.append(run(lab, f"{stopped}.{transport}.{stop_s}", stopped, transport, stop_s))
    return rows
