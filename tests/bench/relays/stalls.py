# SPDX-License-Identifier: MIT
"""A server, an edge or a client that stands still (SIGSTOP), and a network that is cut, at a hand in contact.

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


def start_servers(lab, name, stopped):
    """Starts a server, and an edge or a network if that is to be stopped. Returns the servers, those of viewers last,
    and the address for viewers."""
    flags = ["--source", "synthetic:still", "--loop"]
    if stopped == "network":
        lab.make_network()
        address = lab.add_host("host1", 1)
        lab.add_host("host2", 2)
        server = lab.server(f"{name}.server", *flags, host="host1", listen=f"{address}:7447")
        server.wait_for("listening on ")
        return [server], f"{address}:7447"
    if stopped != "edge":
        servers = [lab.server(f"{name}.server", *flags)]
    else:
        channel = f"nats://{lab.nats()}/stall"
        servers = [lab.server(f"{name}.server", *flags, "--publish", channel),
                   lab.server(f"{name}.edge", "--source", channel)]
    return servers, servers[-1].address()


def stop(lab, process, seconds):
    """Stops a program, or without one the network. Returns the true length."""
    begin_s = time.monotonic()
    if process:
        process.process.send_signal(signal.SIGSTOP)
    else:
        lab.set_link("between1", False)
    time.sleep(seconds)
    if process:
        process.process.send_signal(signal.SIGCONT)
    else:
        lab.set_link("between1", True)
    return time.monotonic() - begin_s


def run(lab, name, stopped, transport, stop_s):
    """Returns the row of one stop. `stopped`: server, edge, client or network."""
    log = lab.out / f"{name}.csv"
    servers, address = start_servers(lab, name, stopped)
    client = lab.start(f"{name}.client", lab.build / "client/hapticast-client", address, "--device", "virtual",
                       "--hand", "follow", "--view", "off", "--fault-dir", lab.out, "--log", log, "--transport",
                       transport, "--summary", lab.out / f"{name}.json", host="host2" if stopped == "network" else None)
    client.wait_for("connected: ")
    time.sleep(STEADY_s)
    begin_s = time.monotonic()
    stopped_s = stop(lab, {"server": servers[-1], "edge": servers[-1], "client": client}.get(stopped), stop_s)
    time.sleep(AFTER_s + (2.0 if stop_s > 2.0 else 0.0))
    end_s = time.monotonic()
    client.end(signal.SIGTERM)
    for server in reversed(servers):
        server.end(signal.SIGTERM)
    excess_N = json.loads((lab.out / f"{name}.json").read_text())["step_excess_max_N"]
    back_s, delays_s = evaluate(read_log(log), end_s - begin_s, stopped_s)
    return {"stopped": stopped, "transport": transport, "stop s": stop_s, "force back after s": f"{back_s:.2f}",
            "delay +2 frames ms": f"{1e3 * delays_s[0]:.0f}", "delay +2 s ms": f"{1e3 * delays_s[1]:.0f}",
            "step excess N": f"{excess_N:.3f}"}


def run_stalls(build, out):
    """Returns a row for each stop of a server, an edge, a client and a network (as root), by UDP and by TCP."""
    stops = [(stopped, transport, stop_s) for stopped in ("server", "edge") for transport in ("udp", "tcp")
             for stop_s in STOPS_s]
    stops += [("client", transport, 4.0) for transport in ("udp", "tcp")]
    stops += [("network", transport, 1.5) for transport in ("udp", "tcp")]
    rows = []
    for stopped, transport, stop_s in stops:
        with Lab(build, out) as lab:
            rows.append(run(lab, f"{stopped}.{transport}.{stop_s}", stopped, transport, stop_s))
    return rows
