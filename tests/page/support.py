# SPDX-License-Identifier: MIT
"""What the tests of the page share: a server as a program, Chromium, and the words for both.

The server is the real one, and the page comes from it. Chromium runs without a window and draws by
software. Every wait is for a condition. Its deadline only ends a test that has failed.
"""

import contextlib
import math
import os
import pathlib
import re
import shutil
import signal
import sys
import tempfile
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    webdriver = None

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from programs import SERVER, Program  # pylint: disable=wrong-import-position
from waiting import SOON_S, wait_until  # pylint: disable=wrong-import-position

SHOTS = os.environ.get("HAPTICAST_PAGE_SHOTS")  # a folder for screenshots; without it there are none
AXE = os.environ.get("HAPTICAST_AXE", "build/npm/node_modules/axe-core/axe.min.js")
STILL = ["--source", "synthetic:still", "--loop", "--map-range", "520,620", "--motion", "none"]
DEEP = 21  # notches of the wheel from the start (35 mm) to 10 mm below the top of this ball (24 mm)
STATE = "[hapticast.status, hapticast.report, hapticast.stats]"
SKIPPED = 77  # ctest's code for a test that was left out


def find_missing():
    """Returns why the tests cannot run here, or an empty text."""
    if webdriver is None:
        return "selenium was not found: apt-get install python3-selenium"
    for program, package in (("chromium", "chromium"), ("chromedriver", "chromium-driver")):
        if not shutil.which(program):
            return f"{program} was not found: apt-get install {package}"
    return ""


def main(missing=""):
    """Runs the tests of a file, unless something is `missing`. SIGTERM ends all programs, too."""
    missing = missing or find_missing()
    if missing:
        print("left out:", missing)
        sys.exit(SKIPPED)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("the test took too long"))
    unittest.main(verbosity=2)


class Server(Program):
    """hapticast-server as a user runs it. `link` is the one that it prints."""

    def __init__(self, *arguments, listen="127.0.0.1:0"):
        self.state = tempfile.TemporaryDirectory(prefix="hapticast-page-")
        super().__init__(SERVER, *arguments, "--listen", listen,
                         log=pathlib.Path(self.state.name, "log"),
                         env={**os.environ, "XDG_STATE_HOME": self.state.name})
        try:
            self.link = self.wait_for(r"touch it in a browser: (\S+)") if "off" not in arguments else \
                f"http://{self.address()}/"
        except BaseException:
            self.stop()
            raise
        self.port = int(re.search(r":(\d+)/", self.link)[1])

    def stop(self):
        super().stop()
        self.state.cleanup()


class Browser:
    """Chromium with one page. `script` of the methods is JavaScript in that page."""

    def __init__(self, width=1280, height=800, *flags):
        self.folder = tempfile.TemporaryDirectory(prefix="hapticast-chromium-")
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for flag in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--disable-dev-shm-usage",
                     "--disable-background-networking", f"--window-size={width},{height}",
                     f"--user-data-dir={self.folder.name}", *flags):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(
            service=Service(shutil.which("chromedriver")), options=options)
        self.set_screen(width, height)
        self.pressing = None

    def stop(self):
        with contextlib.suppress(Exception):
            self.driver.quit()
        self.folder.cleanup()

    def command(self, name, **parameters):
        """Sends a command of Chromium's DevTools protocol."""
        return self.driver.execute_cdp_cmd(name, parameters)

    def set_screen(self, width, height, touch=False):
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height,
                     deviceScaleFactor=1, mobile=touch)
        self.command("Emulation.setTouchEmulationEnabled", enabled=touch)

    def open(self, link):
        """Opens a link, also one that differs in its fragment alone."""
        self.driver.get("about:blank")
        self.driver.get(link)
        return self

    def touchable(self, link):
        """Opens a link and waits until the object can be touched."""
        self.open(link)
        self.wait("hapticast.status.state === 'connected' && hapticast.stats.pictures_shown > 0"
                  " && hapticast.report?.lookup === 'interpolated'", "no picture is shown")
        return self

    def leave(self):
        """Leaves the page; forgets its settings and its errors."""
        self.pressing = None
        self.driver.execute_script("if (location.host) localStorage.clear()")
        self.driver.get("about:blank")
        self.errors()

    def get(self, script):
        return self.driver.execute_script("return " + script)

    def wait(self, script, what, seconds=SOON_S):
        """Waits until `script` is true; returns its value."""
        return wait_until(lambda: self.get(script), lambda: f"{what}: {self.get(STATE)}", seconds)

    def wait_for_state(self, state, seconds=SOON_S):
        self.wait(f"window.hapticast?.status.state === '{state}'", f"the page is not {state}", seconds)

    def text(self, name):
        return self.get(f"document.getElementById('{name}').innerText").strip()

    def is_shown(self, name):
        return self.get(f"document.getElementById('{name}').checkVisibility()")

    def force_N(self):
        return math.hypot(*self.get("hapticast.report.force_N"))

    def press_by(self, press, lift):
        """Presses by the function `press`; `lift` takes it back."""
        self.pressing = press, lift
        press()

    def wait_pressed(self, script, what):
        """Waits as wait() does, while something presses. On a busy machine the page is late, the hand sinks too deep,
        and there is no force until it has left the object: then it is lifted, and presses again."""
        def find():
            value = self.get(script)
            if not value and self.pressing and "lift the tip" in self.get("hapticast.report.advice"):
                press, lift = self.pressing
                lift()
                self.wait("!hapticast.report.advice.includes('lift the tip')", "the tip is not lifted")
                press()
            return value
        return wait_until(find, lambda: f"{what}: {self.get(STATE)}")

    def wait_for_force(self):
        """Waits for a contact with more than 0.1 N. Returns the force."""
        force = "Math.hypot(...hapticast.report.force_N)"
        return self.wait_pressed(f"hapticast.report.contact && {force} > 0.1 ? {force} : 0", "there is no force")

    def wait_for_no_force(self):
        return self.wait("Math.hypot(...hapticast.report.force_N) < 0.001 && !hapticast.report.contact",
                         "the force stays")

    def place(self, x_mm=0, y_mm=0, element="flat"):
        """Returns the point of the window where the flat picture has a nominal position."""
        x, y, width, height = self.get(
            f"(b => [b.x, b.y, b.width, b.height])"
            f"(document.getElementById('{element}').getBoundingClientRect())")
        stream = self.get("hapticast.stream")
        zoom = min(width / stream["width_px"], height / stream["height_px"])
        scale = min(stream["width_mm"] / stream["width_px"], stream["height_mm"] / stream["height_px"])
        return x + width / 2 + zoom * x_mm / scale, y + height / 2 - zoom * y_mm / scale

    def mouse(self, kind, at, **parameters):
        self.command("Input.dispatchMouseEvent", type="mouse" + kind, x=at[0], y=at[1], **parameters)

    def wheel(self, at, notches):
        """Turns the wheel: positive values press."""
        for _ in range(abs(notches)):
            self.mouse("Wheel", at, deltaX=0, deltaY=math.copysign(100, notches))

    def press(self, at, notches=DEEP):
        """Presses by the wheel."""
        self.press_by(lambda: self.wheel(at, notches), lambda: self.wheel(at, -notches))
        self.wait_pressed("hapticast.report.contact || "
                          "Math.abs(hapticast.report.hip_mm[2] - hapticast.stats.target_mm[2]) < 0.5",
                          "the tip does not follow")

    def fingers(self, kind, *points):
        """Sends a touch event with the fingers that are down."""
        self.command("Input.dispatchTouchEvent", type="touch" + kind, touchPoints=[
            {"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])

    def errors(self):
        """Returns the errors that the browser has logged since the last call."""
        return [each["message"] for each in self.driver.get_log("browser")
                if each["level"] in ("SEVERE", "WARNING")]

    def shoot(self, name):
        """Keeps a screenshot, if somebody wants to look at it."""
        if SHOTS:
            self.driver.save_screenshot(f"{SHOTS}/{name}.png")


class PageTest(unittest.TestCase):
    """A test with one browser for all of its cases, and any number of servers."""
    SCREEN = (800, 600)  # px: the flat picture; a software renderer draws a larger page slowly
    FLAGS = ()

    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(*cls.SCREEN, *cls.FLAGS)
        cls.addClassCleanup(cls.browser.stop)

    @classmethod
    def serve_all(cls, *arguments):
        """Starts a server for all cases."""
        server = Server(*arguments)
        cls.addClassCleanup(server.stop)
        return server

    def setUp(self):
        self.addCleanup(self.browser.leave)
        self.addCleanup(self.browser.command, "Emulation.setEmulatedMedia", features=[])
        self.addCleanup(self.browser.set_screen, *self.SCREEN)

    def serve(self, *arguments, **options):
        server = Server(*arguments, **options)
        self.addCleanup(server.stop)
        return server


class BallTest(PageTest):
    """A test with one server for all of its cases: a ball at rest in the middle."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server = cls.serve_all(*STILL)
