# SPDX-License-Identifier: MIT
"""What an edge costs: delay, processor time, lost frames among 2,000 viewers, a stalled neighbour, and clock error.

All programs run on loopback of this machine.
"""
import json
import re
import signal
import statistics
import time

from lab import Lab, Viewer, quantile, watch

FPS = 25

def start_relays(lab, edges, *flags):
    """Returns the NATS server's address, an origin and edges."""
    nats = lab.nats()
    origin = lab.server("origin", "--source", "synthetic:bounce", "--loop", "--publish", f"nats://{nats}/bench", *flags)
    origin.wait_for("active")
    made = [lab.server(f"edge{i + 1}", "--source", f"nats://{nats}/bench", "--max-clients", 1100)
            for i in range(edges)]
    for edge in made:
        edge.wait_for("streaming")
    return nats, origin, made


def behind_ms(direct, edge, after_ns=0, before_ns=1 << 62):
    """Returns how much later than at the origin's own port each frame arrived through an edge."""
    return [1e-6 * (edge.arrivals_ns[frame] - at_ns) for frame, at_ns in direct.arrivals_ns.items()
            if frame in edge.arrivals_ns and after_ns <= at_ns < before_ns]


def figures(values_ms):
    return {"p50_ms": round(quantile(values_ms, 0.5), 2), "p99_ms": round(quantile(values_ms, 0.99), 2),
            "max_ms": round(max(values_ms, default=float("nan")), 2), "frames": len(values_ms)}


def use_cpu(servers, seconds):
    """Returns the processor time of each thread of each server in the next seconds, s."""
    before = [server.cpu_s() for server in servers]
    time.sleep(seconds)
    return [{thread: used_s - was.get(thread, 0.0) for thread, used_s in server.cpu_s().items()}
            for server, was in zip(servers, before)]


def measure_delay_and_cost(build, out, viewers=200, rounds=4, seconds=8):
    """The edge costs all that it computes. Of the plain server the threads that rest without viewers count, so that the
    cost of its vision is left out."""
    with Lab(build, out) as lab:
        _, origin, (edge,) = start_relays(lab, 1)
        direct, through = Viewer(origin.address()), Viewer(edge.address())
        watch([direct, through], 30)
        later_ms = figures(behind_ms(direct, through))
        direct.socket.close()
        through.socket.close()
        plain = lab.server("plain", "--source", "synthetic:bounce", "--loop", "--max-clients", 1100)
        plain.wait_for("streaming")
        costs = []
        for i in range(rounds):
            plain_alone, edge_alone = use_cpu([plain, edge], seconds)
            crowds = [lab.viewers(f"viewers {i} {name}", server.address(), viewers, seconds + 6)
                      for name, server in (("plain", plain), ("edge", edge))]
            time.sleep(4)  # all have joined
            plain_used, edge_used = use_cpu([plain, edge], seconds)
            for crowd in crowds:
                crowd.process.wait(60)
            resting = [thread for thread, used_s in plain_alone.items() if used_s < 0.005 * seconds]
            plain_s = sum(plain_used[thread] - plain_alone[thread] for thread in resting)
            costs.append([1e6 * used_s / (FPS * seconds * viewers)
                          for used_s in (plain_s, sum(edge_used.values()), sum(edge_alone.values()))])
    print(f"  CPU us for each of {viewers} viewers and each frame, by round: "
          + "; ".join("plain {:.2f}, edge {:.2f} (without viewers {:.2f})".format(*cost) for cost in costs))
    ratio = statistics.median(edge_us / plain_us for plain_us, edge_us, _ in costs)
    return [{"what": "delay through an edge", **later_ms, "required": "p50 2, p99 10 ms"},
            {"what": "CPU edge / plain server", **dict.fromkeys(later_ms, ""), "p50_ms": f"x {ratio:.2f}",
             "required": "x 1.1"}]


def measure_crowd(build, out, seconds=20, rounds=2):
    rows = []
    with Lab(build, out) as lab:
        _, _, edges = start_relays(lab, 2, "--fps", 10)
        plain = lab.server("plain", "--source", "synthetic:bounce", "--loop", "--fps", 10, "--max-clients", 2100)
        plain.wait_for("streaming")
        for i in range(rounds):
            for what, servers in (("two edges", edges), ("one server", [plain])):
                crowds = [lab.viewers(f"{what} {i} {k}", server.address(), 2000 // len(servers), seconds)
                          for k, server in enumerate(servers)]
                for crowd in crowds:
                    crowd.process.wait(seconds + 120)
                    line = next((line for line in crowd.output().splitlines() if "viewers: got" in line), crowd.output())
                    found = re.search(r"(\d+) viewers: got (\d+) of (\d+) frames .*?(\d+) MB/s.*p50 ([\d.]+), p99 ([\d.]+)",
                                      line)
                    count, got, expected, rate_MB_s, p50_ms, p99_ms = found.groups()
                    rows.append({"round": i, "what": what, "viewers": count, "frames": expected,
                                 "lost": int(expected) - int(got), "MB/s": rate_MB_s, "p50_ms": p50_ms,
                                 "p99_ms": p99_ms})
    return rows


def measure_stall(build, out, seconds=20):
    with Lab(build, out) as lab:
        _, origin, (edge, stalled) = start_relays(lab, 2)
        direct, through = Viewer(origin.address()), Viewer(edge.address())
        watch([direct, through], seconds)
        stopped_ns = time.monotonic_ns()
        stalled.process.send_signal(signal.SIGSTOP)
        watch([direct, through], seconds)
        continued_ns = time.monotonic_ns()
        stalled.process.send_signal(signal.SIGCONT)
        watch([direct, through], seconds / 2)
        parts = {"before": (0, stopped_ns), "during": (stopped_ns, continued_ns), "after": (continued_ns, 1 << 62)}
        rows = []
        for name, part in parts.items():
            # Arrival less capture; the constant difference of the clocks is taken out.
            delays_ms = [1e-6 * (at_ns - through.media_ns[frame]) for frame, at_ns in through.arrivals_ns.items()
                         if part[0] <= at_ns < part[1]]
            least_ms = min(1e-6 * (at - through.media_ns[frame]) for frame, at in through.arrivals_ns.items())
            rows.append({"part": name, **figures(behind_ms(direct, through, *part)),
                         "p99_since_capture_ms": round(quantile(delays_ms, 0.99) - least_ms, 2)})
        print("  log of the stalled edge: " + stalled.output().strip().splitlines()[-1])
        return rows


def measure_clocks(build, out, edges=8):
    """Each edge and its client are behind links with a delay of 20 +- 10 ms each way. Seeds differ."""
    rows = []
    for seconds in (10, 60):
        with Lab(build, out) as lab:
            nats, origin, _ = start_relays(lab, 0)
            clients, servers = [], []
            for seed in range(1, edges + 1):
                to_nats = add_link(lab, f"to_nats{seed}", nats, seed)
                edge = lab.server(f"edge{seed}", "--source", f"nats://{to_nats}/bench")
                edge.wait_for("streaming")
                servers.append(edge)
                to_edge = add_link(lab, f"to_edge{seed}", edge.address(), 100 + seed)
                clients.append(lab.client(f"client{seed}", to_edge, "--seconds", seconds))
            clients.append(lab.client("direct", origin.address(), "--seconds", seconds))
            servers.append(origin)
            time.sleep(seconds - 1)
            viewers = [Viewer(server.address()) for server in servers]
            watch(viewers, 0.5)
            # Without a link between them, the quickest ping shows a server's media clock to some microseconds.
            clocks_us = [min(viewer.pongs)[1] / 1e3 for viewer in viewers]
            for client in clients:
                if client.process.wait(seconds + 30) != 0:
                    raise RuntimeError(client.output())
            summaries = [json.loads((out / f"{name}.json").read_text())
                         for name in [*(f"client{seed}" for seed in range(1, edges + 1)), "direct"]]
        true_us = summaries[-1]["clock_offset_us"]
        for seed, summary in enumerate(summaries, 1):
            rows.append({"seconds": seconds, "seed": seed if seed <= edges else "direct",
                         "edge_error_ms": round((clocks_us[seed - 1] - clocks_us[-1]) / 1e3, 3),
                         "error_ms": round((summary["clock_offset_us"] - true_us) / 1e3, 3),
                         "bound_ms": round(summary["clock_error_us"] / 1e3, 3),
                         "step_excess_max_N": summary["step_excess_max_N"], "lost": summary["frames"]["lost"],
                         "playout_ms": round(summary["playout_delay_ms"], 1)})
    return rows


def add_link(lab, name, server, seed):
    """Returns the address of a link to a server: 10 ms, and up to 20 ms on top, each way."""
    link = lab.start(name, lab.build / "tests/hapticast-link", "--listen", "127.0.0.1:0", "--server", server,
                     "--delay", 10, "--jitter", 20, "--seed", seed, "--quiet")
    return link.wait_for("relaying (.*) to .*; Ctrl-C")


COSTS = {"e": measure_delay_and_cost, "f": measure_crowd, "g": measure_stall, "h": measure_clocks}
