# SPDX-License-Identifier: MIT
"""Failures of a relay network in the middle of a run, as 10 real clients and 190 test viewers see them.

Side 1 has NATS node 1, origin 1 (active) and edges 1 and 2. Side 2 has nodes 2 and 3, origin 2 (standby) and edges 3 to
6. The clients and viewers of an edge run on its host.
"""
import csv
import itertools
import json
import signal
import time

from lab import Lab

CLIENTS = [2, 2, 2, 2, 1, 1]  # of each edge
VIEWERS = [32, 32, 32, 32, 31, 31]
STEADY_s = 5  # before the failure
CUT_s = 5
CLOCKS_APART_s = 8  # between the origins; play time stands still in a gap, so a client can be some seconds behind
AFTER_s = 12
MOST_BACK_s = {"a": 2.0, "b": 2.0, "c": 2.0, "d": 3.0}
HANDOVER_s = 5
GAP_s = 0.15  # four frames; shorter times are jitter of a busy machine
AIM_BACK_s = {"a": 1.0, "b": 1.0, "c": 1.0, "d": 1.5}


class Network:
    """Three nodes, two origins, six edges, and their viewers."""

    def __init__(self, lab):
        self.lab = lab
        lab.make_network()
        nodes = {f"node{i}": lab.add_host(f"node{i}", 1 if i == 1 else 2) for i in (1, 2, 3)}
        self.node_at = {address: name for name, address in nodes.items()}
        routes = ",".join(f"nats://{address}:6222" for address in nodes.values())
        self.nodes = {
            name: lab.start(name, "nats-server", "-a", address, "-p", 4222, "--cluster_name", "relays",
                            "--cluster", f"nats://{address}:6222", "--routes", routes, host=name)
            for name, address in nodes.items()}
        for node in self.nodes.values():
            node.wait_for("Server is ready")
        orders = list(itertools.permutations(nodes.values()))
        self.origins = [self._start_origin(0, orders[0])]
        time.sleep(CLOCKS_APART_s)
        self.origins.append(self._start_origin(1, orders[1]))
        self.edges = [self._start_edge(i, orders[i]) for i in range(6)]
        self.clients = {}
        for i, count in enumerate(CLIENTS):
            for k in range(count):
                name = f"client{i + 1}.{k + 1}"
                self.clients[name] = lab.client(name, "127.0.0.1:7447", "--log", lab.out / f"{name}.csv",
                                                host=f"edge{i + 1}")
        self.viewers = [lab.viewers(f"viewers{i + 1}", "127.0.0.1:7447", count, CUT_s + STEADY_s + AFTER_s + 5,
                                    host=f"edge{i + 1}") for i, count in enumerate(VIEWERS)]

    def _start_origin(self, i, servers):
        name = f"origin{i + 1}"
        self.lab.add_host(name, i + 1)
        origin = self.lab.server(name, "--source", "synthetic:bounce", "--loop", "--publish",
                                 "nats://" + ",".join(servers) + "/bench", host=name)
        origin.wait_for("streaming")
        if i == 0:
            origin.wait_for("active")
        return origin

    def _start_edge(self, i, servers):
        name = f"edge{i + 1}"
        self.lab.add_host(name, 1 if i < 2 else 2)
        edge = self.lab.server(name, "--source", "nats://" + ",".join(servers) + "/bench", host=name,
                               listen="127.0.0.1:7447")
        edge.wait_for("streaming")
        return edge


# Each failure returns the time from which "frames are back" counts.

def kill_node(network):
    node = network.node_at[network.lab.nats_of("origin1")]
    print(f"  {node} is killed; the active origin is connected to it, and of the edges "
          + ", ".join(str(i) for i in range(1, 7) if network.node_at[network.lab.nats_of(f"edge{i}")] == node))
    network.nodes[node].process.kill()
    return time.monotonic()


def cut(network, link):
    network.lab.set_link(link, False)
    time.sleep(CUT_s)
    network.lab.set_link(link, True)
    return time.monotonic()


def cut_edge(network):
    return cut(network, "edge1")


def part_sides(network):
    return cut(network, "between1")


def kill_origin(network):
    network.origins[0].process.kill()
    return time.monotonic()


FAILURES = {"a": ("a NATS node is killed", kill_node), "b": ("edge 1 is cut off for 5 s", cut_edge),
            "c": ("partition for 5 s", part_sides), "d": ("the active origin is killed", kill_origin)}


def begin_of_log(logs, seconds):
    """Returns for each log the local time of t_s = 0: the earliest that its newest row allows."""
    begin = dict.fromkeys(logs, float("inf"))
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for name, log in logs.items():
            with open(log, "rb") as file:
                file.seek(-600, 2)
                lines = file.read().split(b"\n")
                begin[name] = min(begin[name], time.monotonic() - float(lines[-2].split(b",")[0]))
        time.sleep(0.037)  # in no step with the clients' writing
    return begin


def find_gaps(rows, begin_s, end_s):
    """Returns begin and end of each time of more than GAP_s without fresh frames of which a part is in begin_s..end_s."""
    gaps, last_fresh_s = [], rows[0][0]
    for t_s, _, fresh in rows:
        if fresh:
            if t_s - last_fresh_s > GAP_s and t_s > begin_s and last_fresh_s <= end_s:
                gaps.append((last_fresh_s, t_s))
            last_fresh_s = t_s
    if rows[-1][0] - last_fresh_s > GAP_s and last_fresh_s <= end_s:  # never back
        gaps.append((last_fresh_s, float("inf")))
    return gaps


def origins_seen(rows, starts_s):
    """Returns the origins in the order in which a client rendered their frames, by their media clocks."""
    seen = []
    for t_s, media_s, fresh in rows:
        if not fresh:
            continue
        origin = min((1, 2), key=lambda i: abs(t_s - media_s - starts_s[i - 1]))
        if not seen or seen[-1] != origin:
            seen.append(origin)
    return seen


def read_log(file, begin_s):
    with open(file, newline="") as rows:
        return [(begin_s + float(row["t_s"]), float(row["media_s"]), row["lookup"] == "interpolated")
                for row in csv.DictReader(rows)]


def run_failure(letter, build, out):
    """Runs one failure. Returns a row for each client."""
    what, fail = FAILURES[letter]
    print(f"{letter}) {what}")
    with Lab(build, out / letter) as lab:
        network = Network(lab)
        time.sleep(6)  # all have joined
        logs = {name: lab.out / f"{name}.csv" for name in network.clients}
        begin = begin_of_log(logs, STEADY_s)
        failed_s = time.monotonic()
        back_from_s = fail(network)
        time.sleep(AFTER_s)
        for client in network.clients.values():
            client.process.send_signal(signal.SIGTERM)
        for name, client in network.clients.items():
            if client.process.wait(10) != 0:
                raise RuntimeError(f"{name} has failed: {client.output()}")
        for viewers in network.viewers:
            if viewers.process.wait(30) != 0:
                print("  test viewers: " + viewers.output().strip().splitlines()[-1])
        changes = [edge.output().count("another origin sends from now on") for edge in network.edges]
        print(f"  changes of the origin at the edges: {changes}")
        rows = []
        for name in network.clients:
            ticks = read_log(logs[name], begin[name])
            summary = json.loads((lab.out / f"{name}.json").read_text())
            # What begins later is not due to the failure. After a partition, frames can stop once more at the handover.
            gaps = find_gaps(ticks, failed_s, back_from_s + HANDOVER_s)
            later = find_gaps(ticks, back_from_s + HANDOVER_s, back_from_s + AFTER_s - 1)
            rows.append({"scenario": letter, "client": name,
                         "gap_s": round(max((end - begin_s for begin_s, end in gaps), default=0.0), 2),
                         "back_s": round(max((end - back_from_s for _, end in gaps), default=0.0), 2),
                         "later_gaps": len(later),
                         "step_excess_max_N": summary["step_excess_max_N"],
                         "origins": "".join(map(str, origins_seen(ticks, [o.started_s for o in network.origins]))),
                         "lost": summary["frames"]["lost"], "late_ticks": summary["late_ticks"],
                         "clock_offset_ms": round(summary["clock_offset_us"] / 1e3, 2),
                         "faults": " ".join(summary["faults"])})
    judge(letter, rows, out)
    return rows


def judge(letter, rows, out):
    back_s = max(row["back_s"] for row in rows)
    excess_N = max(row["step_excess_max_N"] for row in rows)
    in_order = all(row["origins"] in ("1", "12") for row in rows)
    last = {row["origins"][-1:] for row in rows}
    print(f"  back after at most {back_s:.2f} s (required {MOST_BACK_s[letter]}, aim {AIM_BACK_s[letter]}); "
          f"step_excess_max_N {excess_N} (required 0); origins in order: {in_order}, all end at one: {len(last) == 1}")
