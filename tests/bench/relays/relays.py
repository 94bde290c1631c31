#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures relays over NATS and their failures.

  tests/bench/relays/relays.py [a b c d e f g h i j]    all, or some

a-d: failures (failures.py; root, `ip netns`). e-h: delay, cost, many viewers, a stalled edge, clocks (costs.py). i: programs that stand still (stalls.py). j: floods of pings (floods.py).
Needs nats-server, and the programs hapticast-server, hapticast-client, hapticast-viewers and hapticast-link.
"""
import argparse
import csv
import os
from pathlib import Path

from costs import COSTS
from failures import FAILURES, run_failure
from floods import measure_floods
from stalls import run_stalls


def write(name, rows, out):
    """Prints a table of dictionaries and writes it as CSV."""
    columns = list(rows[0])
    with open(out / f"{name}.csv", "w", newline="") as file:
        table = csv.DictWriter(file, columns)
        table.writeheader()
        table.writerows(rows)
    widths = [max(len(str(text)) for text in [column, *(row[column] for row in rows)]) for column in columns]
    for line in [columns, *(row.values() for row in rows)]:
        print("  " + "  ".join(str(text).rjust(width) for text, width in zip(line, widths)))


def main():
    root = Path(__file__).resolve().parents[3]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenarios", nargs="*", default=list("abcdefghij"), metavar="a..j")
    parser.add_argument("--build", type=Path, default=root / "build/release")
    parser.add_argument("--out", type=Path, default=root / "build/relays")
    settings = parser.parse_args()
    os.nice(-10)  # other work on the machine disturbs less
    for letter in settings.scenarios:
        if letter in FAILURES:
            rows = run_failure(letter, settings.build, settings.out)
        elif letter == "i":
            rows = run_stalls(settings.build, settings.out / letter)
        elif letter == "j":
            rows = measure_floods(settings.build, settings.out / letter)
        elif letter in COSTS:
            rows = COSTS[letter](settings.build, settings.out / letter)
        else:
            parser.error(f"{letter} is not one of a..j")
        write(letter, rows, settings.out)
        print(f"  load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors", flush=True)


if __name__ == "__main__":
    main()
