# SPDX-License-Identifier: MIT
"""Fingers, a pen and a gamepad touch the ball; rumble and vibration are asked of the browser."""

import support

# A gamepad of the standard mapping and a motor of a phone. Each keeps what the page asks of it.
DEVICES = """
window.effects = [];
window.pulses = [];
window.pad = {
  id: 'test', index: 0, connected: true, mapping: 'standard', timestamp: 0, axes: [0, 0, 0, 0],
  buttons: Array.from({length: 17}, () => ({pressed: false, touched: false, value: 0})),
  vibrationActuator: {
    playEffect(...effect) { effects.push(effect); return Promise.resolve('complete'); },
    reset() { effects.push(['reset']); return Promise.resolve('complete'); },
  },
};
navigator.getGamepads = () => [null, pad];
navigator.vibrate = pulse_ms => { pulses.push(pulse_ms); return true; };
"""


class Fingers(support.BallTest):

    def setUp(self):
        super().setUp()
        self.page = self.browser.touchable(self.server.link)
        self.page.set_screen(*self.SCREEN, touch=True)

    def test_a_resting_finger_presses_until_it_is_lifted(self):
        at = self.page.place()
        self.page.fingers("Start", at)
        self.assertGreater(self.page.wait_for_force(), 0.1)
        self.page.wait("Math.hypot(...hapticast.report.force_N) > 0.9", "the press is not firm")
        self.page.fingers("End")
        self.page.wait_for_no_force()
        self.page.wait("hapticast.report.hip_mm[2] > 30", "the tip is not lifted")

    def test_a_moving_finger_moves_the_tip(self):
        x, y = self.page.place(-40, 20)
        self.page.fingers("Start", (x, y))
        for step in range(1, 9):
            self.page.fingers("Move", (x + 15 * step, y))
        wanted_mm = self.page.get("hapticast.stats.target_mm")
        self.assertGreater(wanted_mm[0], -35)
        self.assertAlmostEqual(wanted_mm[1], 20, delta=0.5)
        self.page.fingers("End")

    def test_a_finger_that_slides_over_the_ball_while_it_presses(self):
        x, y = self.page.place()
        self.page.fingers("Start", (x, y))
        self.page.wait_for_force()
        for step in range(1, 6):
            self.page.fingers("Move", (x + 4 * step, y))
        self.page.wait("hapticast.report.contact && hapticast.report.hip_mm[0] > 1.5",
                       "the pressed tip does not follow the finger")
        self.page.fingers("End")
        self.page.wait_for_no_force()

    def test_two_fingers_pinch(self):
        x, y = self.page.place()
        self.page.fingers("Start", (x, y))
        self.page.fingers("Start", (x, y), (x + 200, y))
        for step in range(1, 14):
            self.page.fingers("Move", (x, y), (x + 200 - 12 * step, y))
        self.page.wait_for_force()
        for step in range(12, -1, -1):
            self.page.fingers("Move", (x, y), (x + 200 - 12 * step, y))
        self.page.wait_for_no_force()
        self.page.fingers("End")

    def test_the_button_presses_while_it_is_held(self):
        self.page.get("document.getElementById('press').scrollIntoView()")
        point = self.page.get(
            "(b => [b.x + b.width / 2, b.y + b.height / 2])"
            "(document.getElementById('press').getBoundingClientRect())")
        self.page.fingers("Start", point)
        self.page.wait_for_force()
        self.page.fingers("End")
        self.page.wait_for_no_force()


class Pen(support.BallTest):
    def test_pressure_is_the_depth(self):
        page = self.browser.touchable(self.server.link)
        at = page.place()
        pen = {"button": "left", "buttons": 1, "pointerType": "pen"}
        page.mouse("Pressed", at, force=0.3, clickCount=1, **pen)
        page.wait_for_force()
        page.wait("hapticast.stats.target_mm[2] > 20", "a light pressure is deep")
        light_N = page.wait("hapticast.report.penetration_mm > 1 && Math.hypot(...hapticast.report.force_N)",
                            "the pen does not press")
        page.mouse("Moved", at, force=0.9, **pen)
        page.wait(f"Math.hypot(...hapticast.report.force_N) > {light_N} + 0.3",
                  "more pressure is not more force")
        page.shoot("pen")
        page.mouse("Released", at, button="left", pointerType="pen", clickCount=1)
        page.wait_for_no_force()


class Gamepad(support.BallTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser.command("Page.addScriptToEvaluateOnNewDocument", source=DEVICES)

    def setUp(self):
        super().setUp()
        self.page = self.browser.touchable(self.server.link)

    def set(self, script):
        self.page.driver.execute_script(script)

    def test_sticks_and_triggers(self):
        self.set("pad.axes[0] = 0.8")
        self.page.wait("hapticast.report.hip_mm[0] > 10", "the left stick does not move the tip")
        self.set("pad.axes[0] = -0.8")
        self.page.wait("hapticast.report.hip_mm[0] < 1", "the left stick does not move the tip back")
        self.set("pad.axes[0] = 0.1; pad.axes[3] = -1")  # 0.1 is within the dead zone
        self.page.wait_for_force()
        self.set("pad.axes[3] = 1")
        self.page.wait_for_no_force()
        self.set("pad.axes[3] = 0; pad.buttons[7] = {pressed: true, value: 1}")
        self.page.wait_for_force()

    def test_buttons(self):
        self.set("pad.buttons[9] = {pressed: true, value: 1}")
        self.page.wait("document.getElementById('pause').checked", "Start does not pause")
        self.set("pad.buttons[9] = {pressed: false, value: 0}")
        self.assertTrue(self.page.get("document.getElementById('pause').checked"))

    def test_contact_rumbles_and_vibrates(self):
        self.page.mouse("Pressed", (5, 5), button="left", clickCount=1)  # a browser asks for a tap
        self.page.mouse("Released", (5, 5), button="left", clickCount=1)
        self.assertEqual(self.page.get("effects.length + pulses.length"), 0)
        self.set("pad.buttons[7] = {pressed: true, value: 1}")
        self.page.wait_for_force()
        kind, effect = self.page.wait("effects.find(([kind, e]) => e?.strongMagnitude > 0.1)",
                                      "the gamepad does not rumble")
        self.assertEqual(kind, "dual-rumble")
        self.assertTrue(0 < effect["duration"] <= 200 and effect["strongMagnitude"] <= 1)
        self.page.wait("pulses.some(pulse => pulse > 0 && pulse <= 100)", "the phone does not vibrate")
        self.set("pad.buttons[7] = {pressed: false, value: 0}; pad.axes[3] = 1")
        self.page.wait_for_no_force()
        self.page.wait("effects.at(-1)[0] === 'reset'", "the rumble does not end")
        self.page.wait("pulses.at(-1) === 0", "the vibration does not end")
        if not self.page.is_shown("panel"):
            self.page.get("document.getElementById('panel-button').click()")
        for note in ("sound-note", "rumble-note", "vibration-note"):
            self.assertIn("never tried on hardware", self.page.text(note).lower())
        self.page.get("document.getElementById('rumble-note').scrollIntoView()")
        self.page.shoot("feedback")

    def test_switched_off_feedback_is_silent(self):
        for name in ("rumble", "vibration"):
            self.set(f"document.getElementById('{name}').click()")
        self.set("pad.buttons[7] = {pressed: true, value: 1}")
        self.page.wait_for_force()
        self.page.wait("hapticast.report.penetration_mm > 3", "the gamepad does not press")
        self.assertEqual(self.page.get("[effects.length, pulses.length]"), [0, 0])
        for name in ("rumble", "vibration"):
            self.set(f"document.getElementById('{name}').click()")


if __name__ == "__main__":
    support.main()
