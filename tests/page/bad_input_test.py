# SPDX-License-Identifier: MIT
"""Servers and proxies that answer wrongly: one sentence in the page, which keeps running."""

import random
import urllib.error
import urllib.request

import bad_servers
import support
from bad_servers import make_frame

TEXT, BINARY, PING = 1, 2, 9


class BadInput(support.BallTest):

    def open(self, kind, *arguments):
        between = kind(self.server.port, *arguments)
        self.addCleanup(between.stop)
        self.browser.open(between.link)
        return between

    def check_state(self, state, words):
        """The page is in `state` with one sentence, still renders ticks and reacts to a click."""
        page = self.browser
        sentence = page.wait(
            f"hapticast.status.state === '{state}' && document.getElementById('card').checkVisibility() &&"
            f" (text => /{words}/.test(text) && text)(document.getElementById('card-text').innerText)",
            f"the page is not {state} with '{words}'")
        self.assertLess(len(sentence), 120)
        self.assertNotIn("\n", sentence)
        ticks = page.get("hapticast.stats.ticks")
        page.wait(f"hapticast.stats.ticks > {ticks} + 100", "no ticks are rendered")
        was_shown = page.is_shown("panel")
        page.driver.find_element("id", "panel-button").click()
        self.assertNotEqual(page.is_shown("panel"), was_shown)

    def test_a_proxy_that_holds_bytes_back(self):
        self.open(bad_servers.Buffering)
        page = self.browser
        page.wait("hapticast.status.state === 'connected' && hapticast.stats.pictures_shown > 3",
                  "no pictures through the proxy")
        at = page.place()
        page.mouse("Moved", at)
        page.press(at)
        page.wait_for_force()

    def test_an_answer_that_is_no_upgrade(self):
        between = self.open(bad_servers.Refusing)
        self.check_state("retrying", "does not answer")
        self.browser.shoot("no-upgrade")
        self.check_pauses(between)

    def check_pauses(self, between):
        """The page waits a second between its attempts, at last."""
        first = between.streams
        self.browser.driver.execute_script("window.seen = performance.now()")
        self.browser.wait("performance.now() > seen + 3000", "time stands still")
        self.assertLessEqual(between.streams - first, 6)

    def test_no_answer(self):
        self.open(bad_servers.Silent)
        self.check_state("retrying", "no welcome arrived")

    def test_another_subprotocol(self):
        self.open(bad_servers.Sending, b"", "hapticast.4")
        self.check_state("retrying", "does not answer")

    def test_a_text(self):
        between = self.open(bad_servers.Sending, make_frame(TEXT, b"hello"))
        self.check_state("failed", "sent a text")
        self.assertEqual(between.streams, 1)

    def test_bytes_of_chance(self):
        self.open(bad_servers.Sending, make_frame(BINARY, random.Random(1).randbytes(5000)))
        self.check_state("failed", "not a message")
        self.browser.shoot("garbage")

    def test_an_empty_message(self):
        self.open(bad_servers.Sending, make_frame(BINARY, b""))
        self.browser.wait("['failed', 'retrying'].includes(hapticast.status.state)", "it stays connected")

    def test_a_length_of_2_to_the_63rd(self):
        self.open(bad_servers.Sending, make_frame(BINARY, b"abc", 1 << 63))
        self.check_state("retrying", "does not answer")

    def test_a_large_length_without_bytes(self):
        self.open(bad_servers.Sending, make_frame(BINARY, b"abc", 1 << 40))
        self.check_state("retrying", "does not answer|no welcome")

    def test_a_flood_of_pings(self):
        self.open(bad_servers.Sending, make_frame(PING, b"x" * 100) * 10000)
        self.check_state("retrying", "no welcome|does not answer")

    def test_a_stream_that_is_cut(self):
        self.open(bad_servers.Cutting, 30000)
        self.check_state("retrying", "does not answer")

    def test_another_viewer_is_untouched(self):
        """All of these pages were of one server, which logged no warning of them."""
        self.browser.touchable(self.server.link)
        self.assertNotIn("error", self.server.output())


class NoPage(support.PageTest):
    def test_page_off(self):
        server = self.serve(*support.STILL, "--page", "off")
        with self.assertRaises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(server.link)
        sentence = caught.exception.read().decode()
        self.assertRegex(sentence, r"^[A-Z].*--page.*\n$|^[A-Z].*page.*\n$")
        self.assertEqual(caught.exception.code, 400)
        self.browser.open(server.link)
        self.assertIn("page", self.browser.get("document.body.innerText"))
        self.assertNotIn("touch it in a browser", server.output())


if __name__ == "__main__":
    support.main()
