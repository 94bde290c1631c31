# SPDX-License-Identifier: MIT
"""Small screens, and the wishes of a system: motion, colours."""

import support

# The number of running animations and transitions.
MOVING = """document.getAnimations().filter(each => each.playState === 'running').length"""


class Phone(support.BallTest):

    def check_phone(self, width, height):
        page = self.browser
        page.set_screen(width, height, touch=True)
        page.touchable(self.server.link)
        self.assertEqual(page.get("[innerWidth, document.scrollingElement.scrollWidth]"), [width, width])
        too_wide = page.get(
            "[...document.querySelectorAll('body *')].filter(e => e.checkVisibility() && "
            "!e.closest('.hidden') && e.getBoundingClientRect().right > innerWidth + 0.5).map(e => e.id || e.tagName)")
        self.assertEqual(too_wide, [])
        box = page.get("(b => [b.left, b.top, b.right, b.bottom])"
                       "(document.getElementById('flat').getBoundingClientRect())")
        self.assertTrue(box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height, box)
        self.check_buttons()
        self.assertFalse(page.is_shown("panel"))
        at = page.place()
        page.fingers("Start", at)
        page.wait_for_force()
        page.shoot(f"phone-{width}x{height}")
        page.fingers("End")
        page.wait_for_no_force()
        self.check_panel(width)

    def check_buttons(self):
        """Each button can be hit by a finger: 24 px (WCAG 2.2, 2.5.8) at least."""
        small = self.browser.get(
            "[...document.querySelectorAll('button')].filter(e => e.checkVisibility()).map(e => "
            "[e.id, e.offsetWidth, e.offsetHeight]).filter(([, w, h]) => Math.min(w, h) < 24)")
        self.assertEqual(small, [])

    def check_panel(self, width):
        page = self.browser
        page.get("document.getElementById('panel-button').click()")
        self.assertTrue(page.is_shown("panel"))
        self.assertEqual(page.get("document.scrollingElement.scrollWidth"), width)
        page.get("document.getElementById('rumble').scrollIntoView()")
        page.shoot(f"phone-{width}-panel")
        page.get("document.getElementById('help-button').click()")
        self.assertTrue(page.get(
            "(b => b.left >= 0 && b.right <= innerWidth)(document.getElementById('help').getBoundingClientRect())"))
        page.shoot(f"phone-{width}-help")
        page.get("document.getElementById('help').close()")

    def test_320_px(self):
        self.check_phone(320, 568)

    def test_390_px(self):
        self.check_phone(390, 844)


class Wishes(support.BallTest):

    def test_colours_of_the_system(self):
        for scheme, most, least in (("dark", 60, 0), ("light", 255, 200)):
            self.browser.command("Emulation.setEmulatedMedia",
                                 features=[{"name": "prefers-color-scheme", "value": scheme}])
            self.browser.touchable(self.server.link)
            colour = self.browser.get(
                "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
            self.assertTrue(all(least <= part <= most for part in colour), (scheme, colour))
            self.browser.shoot(scheme)

    def test_reduced_motion(self):
        self.browser.command("Emulation.setEmulatedMedia",
                             features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
        page = self.browser.touchable(self.server.link)
        page.get("document.getElementById('help-button').click()")
        self.assertEqual(page.get(MOVING), 0)
        page.get("document.getElementById('help').close()")
        slow = page.get(
            "[...document.querySelectorAll('*')].map(e => getComputedStyle(e)).filter(s => "
            "parseFloat(s.transitionDuration) > 0.01 || parseFloat(s.animationDuration) > 0.01).length")
        self.assertEqual(slow, 0)


if __name__ == "__main__":
    support.main()
