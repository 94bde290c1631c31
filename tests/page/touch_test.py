# SPDX-License-Identifier: MIT
"""The page opens, and mouse and keyboard alone touch a ball at rest."""

import math
import urllib.request

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

import support
# Keeps the reports of the page, each once, from now on.
KEEP_REPORTS = """
window.kept = [];
(function keep() {
  const report = hapticast.report;
  if (report !== kept.at(-1)) kept.push(report);
  requestAnimationFrame(keep);
})();
"""


class Opening(support.BallTest):
    SCREEN = (1210, 500)  # both views

    def test_shows_the_stream(self):
        page = self.browser.touchable(self.server.link)
        page.wait("hapticast.stream.signature === 'signed'", "the frames are not signed")
        self.assertRegex(page.text("signature"), r"^signed by [0-9a-f]{8}")
        self.assertEqual(page.text("name"), "synthetic:still")
        self.assertFalse(page.is_shown("card"))
        self.assertEqual(page.get("hapticast.stats.relief_problem"), "")
        page.wait("hapticast.stats.reliefs > 0", "no relief is drawn")
        self.assertTrue(self.has_colours("picture"))
        page.shoot("connected")
        self.assertEqual(page.errors(), [])

    def has_colours(self, name):
        """Returns whether a canvas shows more than one colour."""
        return self.browser.get(f"""(canvas => {{
          const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
          copy.drawImage(canvas, 0, 0);
          const {{data}} = copy.getImageData(0, 0, canvas.width, canvas.height);
          return new Set(new Uint32Array(data.buffer)).size > 100;
        }})(document.getElementById('{name}'))""")

    def test_asks_no_other_host_and_keeps_nothing(self):
        page = self.browser.touchable(self.server.link)
        page.get("document.getElementById('view-button').click()")
        urls = page.get("performance.getEntriesByType('resource').map(each => each.name)")
        self.assertGreater(len(urls), 5)
        self.assertEqual([url for url in urls if not url.startswith(self.server.link)], [])
        self.assertEqual(page.get("document.cookie"), "")
        self.assertEqual(page.driver.get_cookies(), [])
        self.assertEqual(page.get("Object.keys(localStorage)"), ["hapticast"])
        self.assertEqual(page.get("Object.keys(JSON.parse(localStorage.hapticast)).sort()"),
                         ["letters", "panel", "rumble", "sound", "vibration", "view"])
        self.assertEqual(page.get("sessionStorage.length"), 0)

    def test_runs_no_code_of_others(self):
        with urllib.request.urlopen(self.server.link) as answer:
            policy = answer.headers["Content-Security-Policy"]
            self.assertEqual(answer.headers["X-Content-Type-Options"], "nosniff")
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("unsafe-inline", policy)
        page = self.browser.touchable(self.server.link)
        page.driver.execute_script("""
          window.violations = [];
          addEventListener('securitypolicyviolation', event => violations.push(event.blockedURI));
          const script = document.createElement('script');
          script.textContent = 'window.wasRun = true';
          document.body.append(script);
          new Image().src = 'http://127.0.0.1:9/picture.png';
        """)
        page.wait("violations.length === 2", "the page's policy blocks too little")
        self.assertIsNone(page.get("window.wasRun"))
        page.errors()


class Touch(support.BallTest):

    def setUp(self):
        super().setUp()
        self.page = self.browser.touchable(self.server.link)
        self.page.driver.execute_script(KEEP_REPORTS)

    def press(self, x_mm=0.0, y_mm=0.0, notches=support.DEEP):
        at = self.page.place(x_mm, y_mm)
        self.page.mouse("Moved", at)
        self.page.press(at, notches)
        return at

    def test_wheel_presses_and_lifts(self):
        at = self.press()
        self.page.wait_pressed("hapticast.report.penetration_mm > 2", "the tip is not inside")
        self.assertGreater(self.page.wait_for_force(), 0.1)
        self.page.shoot("contact")
        self.check_drawn_tips()
        self.page.wait_pressed("document.getElementById('advice').innerText.startsWith('in contact') && "
                               "parseFloat(document.getElementById('force-text').innerText) > 0.1",
                               "the page does not say that it is in contact, and with which force")
        self.page.wheel(at, -support.DEEP)
        self.page.wait_for_no_force()

    def check_drawn_tips(self):
        """The tip is drawn at the contact: on the surface, while the hand is below it."""
        kept = [each for each in self.page.get("kept") if each["contact"]]
        self.assertTrue(any(each["hip_mm"][2] < each["height_at_hip_mm"] - 1 for each in kept))
        for each in kept:
            sphere_mm = each["height_at_hip_mm"]
            self.assertGreater(each["contact_mm"][2], sphere_mm - 0.2, each)

    def test_a_press_at_the_side_pushes_aside(self):
        self.press(10, 0)
        self.page.wait_pressed("(f => hapticast.report.contact && f[0] > 0.02 && f[2] > 0)(hapticast.report.force_N)",
                               "the force does not point away from the ball's middle")

    def test_beside_the_ball_is_nothing(self):
        self.press(40, 20)
        self.page.wait("hapticast.report.hip_mm[2] < 16 && hapticast.report.hip_mm[0] > 39",
                       "the tip does not follow")
        self.assertFalse(self.page.get("hapticast.report.contact"))
        self.assertEqual(self.page.force_N(), 0)

    def test_drag_presses_in_place(self):
        x, y = at = self.page.place()
        self.page.mouse("Moved", at)

        def drag():
            self.page.mouse("Pressed", at, button="left", buttons=1, clickCount=1)
            for step in range(1, 11):
                self.page.mouse("Moved", (x, y + 20 * step), button="left", buttons=1)

        def lift():
            self.page.mouse("Released", (x, y + 200), button="left", clickCount=1)
            self.page.driver.find_element("id", "flat").send_keys(Keys.HOME)
        self.page.press_by(drag, lift)
        self.page.wait_for_force()
        self.assertLess(math.hypot(*self.page.get("hapticast.stats.target_mm")[:2]), 0.5)
        lift()
        self.page.wait_for_no_force()
        self.assertEqual(self.page.get("hapticast.stats.target_mm[2]"), 35)

    def test_a_warning_moves_no_picture(self):
        place = "JSON.stringify(document.getElementById('flat').getBoundingClientRect())"
        before = self.page.get(place)
        self.page.driver.execute_script(
            "const states = document.getElementById('states').cloneNode();"
            "Object.assign(states, {hidden: false, innerText: 'the page misses its milliseconds'});"
            "document.getElementById('states').after(states)")
        self.addCleanup(self.page.driver.refresh)
        self.assertEqual(self.page.get(place), before)

    def test_the_relief_is_touched_and_turned(self):
        body = self.page.driver.find_element("id", "flat")
        body.send_keys("v")
        self.assertTrue(self.page.is_shown("relief"))
        self.page.wait("hapticast.stats.reliefs > 0", "no relief is drawn")
        x, y, width, height = self.page.get(
            "(b => [b.x, b.y, b.width, b.height])(document.getElementById('relief').getBoundingClientRect())")
        at = (x + width / 2, y + height / 2)
        self.page.wait("hapticast.stats.reliefs > 1", "the relief is drawn once only")
        self.page.mouse("Moved", at)
        self.page.press(at)
        self.page.wait_for_force()
        self.page.shoot("relief")
        before = self.page.get("hapticast.stats.reliefs")
        self.page.mouse("Pressed", at, button="right", buttons=2, clickCount=1)
        self.page.mouse("Moved", (at[0] + 60, at[1]), button="right", buttons=2)
        self.page.mouse("Released", (at[0] + 60, at[1]), button="right", clickCount=1)
        self.page.wait(f"hapticast.stats.reliefs > {before}", "the relief does not turn")
        body.parent.find_element("tag name", "body").send_keys("vv")

    def test_keyboard_alone_reaches_contact(self):
        keys = ActionChains(self.page.driver)

        def lift():
            keys.key_up("c").perform()
            keys.send_keys(Keys.HOME).perform()
        self.page.press_by(lambda: keys.key_down("c").perform(), lift)
        self.page.wait_for_force()
        lift()
        self.page.wait_for_no_force()
        keys.key_down("h").perform()
        self.page.wait("hapticast.report.hip_mm[0] > 20", "the tip does not move to the right")
        keys.key_up("h").perform()
        self.assertFalse(self.page.get("hapticast.report.over_object"))

    def test_tab_reaches_every_control(self):
        keys = ActionChains(self.page.driver)
        order = []
        for _ in range(5):
            keys.send_keys(Keys.TAB).perform()
            order.append(self.page.get("document.activeElement.id"))
        self.assertEqual(order, ["view-button", "help-button", "panel-button", "flat", "press"])
        keys.send_keys(Keys.F1).perform()
        self.assertTrue(self.page.get("document.getElementById('help').open"))
        self.page.shoot("help")
        keys.send_keys(Keys.ESCAPE).perform()
        self.page.wait("!document.getElementById('help').open", "Escape does not close the help")
        was_open = self.page.is_shown("panel")
        keys.send_keys(Keys.F2).perform()
        self.assertNotEqual(self.page.is_shown("panel"), was_open)
        keys.send_keys(Keys.F2).perform()
        press, lift = (lambda: keys.key_down(Keys.SPACE).perform(), lambda: keys.key_up(Keys.SPACE).perform())
        self.page.press_by(press, lift)  # on the button "hold to press"
        self.page.wait_for_force()
        lift()
        self.page.wait_for_no_force()

    def test_switches_of_the_force(self):
        self.press()
        self.page.wait_for_force()
        keys = ActionChains(self.page.driver)
        keys.send_keys("s").perform()
        self.page.wait("Math.hypot(...hapticast.report.force_N) < 0.01", "S leaves the static force on")
        self.page.wait_pressed("document.getElementById('advice').innerText.includes('press S')",
                               "the page does not say what to do")
        keys.send_keys("s" + Keys.HOME).perform()
        self.page.wait("hapticast.report.hip_mm[2] > 30", "Home does not lift")
        self.assertEqual(self.page.force_N(), 0)
        self.press()
        self.page.wait_for_force()


if __name__ == "__main__":
    support.main()
