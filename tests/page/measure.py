#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the page in Chromium that draws by software, and prints a table. Not in CI.

  HAPTICAST_SERVER=build/release/server/hapticast-server tests/page/measure.py [SECONDS]

First touch: from the start of the navigation to the first report of a contact, while a script moves
the pointer and turns the wheel as soon as there is an object. CPU: that of the
threads of the page's process, from /proc; the page's main thread, the worker, and all others (among
them the decoders of pictures). Late ticks: a call of the worker that is more than 20 ms late.
"""

import os
import pathlib
import sys
import tempfile
import time
import urllib.request

import numpy
from PIL import Image

import support

TICKS_S = os.sysconf("SC_CLK_TCK")
ROUNDS = 5
SIZES_PX = (10, 30, 90, 300)  # of the ball
FRAMES = 60
WIDTH_PX, HEIGHT_PX = 640, 480


def describe(kind, values, unit):
    print(f"| {kind} | {', '.join(values)} {unit} |", flush=True)


def draw_clip(folder, size_px):
    """Draws a clip of one second: a ball that moves a little, on a far wall, with its mask."""
    texture = numpy.random.default_rng(1).integers(60, 200, (HEIGHT_PX, WIDTH_PX, 3), numpy.uint8)
    v, u = numpy.mgrid[:HEIGHT_PX, :WIDTH_PX]
    for part in ("rgb", "depth", "mask"):
        pathlib.Path(folder, part).mkdir()
    for i in range(FRAMES):
        x = WIDTH_PX / 2 + 3 * numpy.sin(2 * numpy.pi * i / FRAMES)
        square = 1 - ((u - x) ** 2 + (v - HEIGHT_PX / 2) ** 2) / (size_px / 2) ** 2
        mask = square > 0
        depth = numpy.where(mask, 900 - 60 * numpy.sqrt(numpy.maximum(square, 0)), 2000)
        for part, image in (("rgb", numpy.where(mask[..., None], texture, texture // 2)),
                            ("depth", depth.astype(numpy.uint16)), ("mask", mask.astype(numpy.uint8))):
            Image.fromarray(image).save(pathlib.Path(folder, part, f"{100 + i}.png"))


def measure_first_touch(browser):
    """The page of each round comes from a server of its own: nothing is in the browser's cache."""
    touch = """
      addEventListener('DOMContentLoaded', () => {
        const flat = document.getElementById('flat');
        let pressed = false;
        (function press() {
          const report = window.hapticast?.report;
          if (report?.contact) return window.touched_ms = performance.now();
          if (report?.over_object && hapticast.stats.pictures_shown > 0 && !pressed) {
            const box = flat.getBoundingClientRect();
            const place = {clientX: box.x + box.width / 2, clientY: box.y + box.height / 2,
                           bubbles: true, cancelable: true, pointerType: 'mouse'};
            flat.dispatchEvent(new PointerEvent('pointermove', place));
            flat.dispatchEvent(new WheelEvent('wheel', {...place, deltaY: 2100}));
            pressed = true;
          }
          setTimeout(press, 5);
        })();
      });"""
    script = browser.command("Page.addScriptToEvaluateOnNewDocument", source=touch)["identifier"]
    times = []
    for _ in range(ROUNDS):
        server = support.Server(*support.STILL)
        try:
            browser.open(server.link)
            times.append(browser.wait("window.touched_ms", "no touch"))
        finally:
            browser.leave()
            server.stop()
    browser.command("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    describe("first touch", [f"{each:.0f}" for each in sorted(times)], "ms")


def measure_bytes():
    """All files of the page, gzipped as the server sends them."""
    server = support.Server(*support.STILL)
    total = {}
    try:
        page = pathlib.Path(__file__).parents[2] / "client/web/page"
        for name in sorted({path.name for path in page.iterdir()} | {"core.wasm"}):
            name = name if name != "index.html" else ""
            request = urllib.request.Request(server.link + name, headers={"Accept-Encoding": "gzip"})
            try:
                with urllib.request.urlopen(request) as answer:
                    total[name or "index.html"] = len(answer.read())
            except OSError:
                print(f"(the server has no {name})")
    finally:
        server.stop()
    describe("bytes of the page, gzipped", [str(sum(total.values()))],
             f"({total['core.wasm']} of them core.wasm)")


def find_renderers(browser):
    """Returns the processes of pages below this Chromium. A link of another host changes the process."""
    renderers = []
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = path.joinpath("cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if "--type=renderer" in words and is_below(path, browser.folder.name):
            renderers.append(path)
    return renderers


def is_below(path, folder):
    """Returns whether a parent of the process is the browser that uses `folder`."""
    while True:
        try:
            parent = path.joinpath("stat").read_text().rsplit(")", 1)[1].split()[1]
            path = pathlib.Path("/proc", parent)
            if folder in path.joinpath("cmdline").read_bytes().decode(errors="replace"):
                return True
        except OSError:
            return False


def read_threads(renderers):
    """Returns the CPU time of each thread by its part: page, worker or others; s."""
    times = {}
    for task in (task for process in renderers for task in process.joinpath("task").glob("*")):
        try:
            name = task.joinpath("comm").read_text().strip()
            words = task.joinpath("stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        part = "page" if task.name == task.parts[2] else "worker" if "Dedicated" in name else "others"
        times[part, task.name] = (int(words[11]) + int(words[12])) / TICKS_S
    return times


def measure_run(browser, server, seconds):
    """Presses. Returns shares of a core by part, the counts of a second, and µs of a tick."""
    browser.touchable(server.link)
    at = browser.place()
    browser.mouse("Moved", at)
    browser.wheel(at, support.DEEP)
    renderers = find_renderers(browser)
    before, counts = read_threads(renderers), browser.get("hapticast.stats")
    begin = time.monotonic()
    time.sleep(seconds)
    after, later = read_threads(renderers), browser.get("hapticast.stats")
    took = time.monotonic() - begin
    parts = {"page": 0.0, "worker": 0.0, "others": 0.0}
    for (part, number), cpu_s in after.items():
        parts[part] += (cpu_s - before.get((part, number), 0.0)) / took
    rates = {name: (later[name] - counts[name]) / took
             for name in ("frames_received", "pictures_shown", "late", "ticks")}
    return parts, rates, later["tick_us"]


def measure_load(browser, size_px, view, seconds):
    with tempfile.TemporaryDirectory(prefix="hapticast-clip-") as folder:
        draw_clip(folder, size_px)
        server = support.Server("--source", folder, "--loop", "--fps", "60")
        try:
            browser.open(server.link)
            browser.driver.execute_script(
                f"localStorage.hapticast = JSON.stringify({{view: '{view}', panel: false}})")
            parts, rates, tick_us = measure_run(browser, server, seconds)
        finally:
            browser.leave()
            server.stop()
    print(f"| {size_px} px, {view} | {parts['page']:.3f} | {parts['worker']:.3f} | {parts['others']:.3f} | "
          f"{rates['frames_received']:.1f} | {rates['pictures_shown']:.1f} | {rates['ticks']:.0f} | "
          f"{100 * rates['late'] / rates['ticks']:.3f} | {tick_us:.1f} |", flush=True)


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    browser = support.Browser(*support.PageTest.SCREEN)
    try:
        print("| quantity | value |\n|---|---|")
        measure_bytes()
        measure_first_touch(browser)
        print(f"\n| {seconds:.0f} s at 60 frames/s | CPU: page's thread | worker | other threads | frames/s | "
              "pictures/s | ticks/s | late, % of ticks | µs a tick |\n" + "|---" * 9 + "|")
        for size_px in SIZES_PX:
            measure_load(browser, size_px, "picture", seconds)
        measure_load(browser, 90, "both", seconds)
    finally:
        browser.stop()


if __name__ == "__main__":
    main()
