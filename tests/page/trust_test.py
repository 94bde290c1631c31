# SPDX-License-Identifier: MIT
"""Encryption, keys of origins, tokens, and what an operator may do."""

import hashlib
import pathlib

import support

VIEWER, OPERATOR = "viewer-0123456789abcdef", "operator-0123456789abcdef"


class Trust(support.PageTest):
    FLAGS = ("--ignore-certificate-errors",)

    def list_tokens(self):
        """Returns a file with a token for a viewer and one for an operator."""
        path = pathlib.Path(self.browser.folder.name, "tokens")
        path.write_text("".join(
            f"{hashlib.sha256(token.encode()).hexdigest()} {role} never\n"
            for token, role in ((VIEWER, "viewer"), (OPERATOR, "operator"))), encoding="ascii")
        path.chmod(0o600)
        return str(path)

    def check_failure(self, link, words):
        """The page fails with one sentence, and does not try again."""
        page = self.browser.open(link)
        page.wait_for_state("failed")
        sentence = page.text("card-text")
        self.assertRegex(sentence, words)
        self.assertLess(len(sentence), 300)
        self.assertTrue(page.is_shown("card"))
        page.driver.execute_script("window.seen = performance.now()")
        page.wait("performance.now() > seen + 1500", "time stands still")  # longer than any pause
        self.assertEqual(page.get("hapticast.status.state"), "failed")
        return sentence

    def test_encrypted(self):
        server = self.serve(*support.STILL, "--tls", "auto")
        self.assertTrue(server.link.startswith("https://"))
        page = self.browser.touchable(server.link)
        page.wait("hapticast.stream.signature === 'signed'", "the frames are not signed")
        self.assertEqual(page.errors(), [])
        self.assertIn("hapticasts://127.0.0.1", page.get("document.querySelector('.command').textContent"))

    def test_key_of_the_origin(self):
        server = self.serve(*support.STILL)
        page = self.browser.touchable(server.link)
        key = page.get("hapticast.stream.key")
        self.assertRegex(key, "^[0-9a-f]{64}$")
        wrong = key[::-1]
        self.check_failure(f"{server.link}#origin-key={wrong}", "key")
        page.shoot("wrong-key")
        connections = server.output().count(" joined")
        page.touchable(f"{server.link}#origin-key={wrong}&origin-key={key}")
        page.wait("hapticast.stream.signature === 'signed'", "the frames are not signed")
        self.assertIn(f"origin-key={key}", page.driver.current_url)
        self.assertLessEqual(server.output().count(" joined"), connections + 1)
        self.check_failure(f"{server.link}#origin-key=0123", "key")
        self.check_failure(f"{server.link}#origin-key=", "key")  # a link that was cut

    def test_tokens(self):
        server = self.serve(*support.STILL, "--tokens", self.list_tokens())
        self.check_failure(server.link, "token|access")
        self.browser.shoot("no-token")
        page = self.browser.touchable(f"{server.link}#token={VIEWER}")
        self.assertNotIn("token", page.driver.current_url)
        self.assertNotIn(VIEWER, page.get("JSON.stringify([location.href, localStorage, document.cookie])"))
        self.assertNotIn(VIEWER, server.output())
        self.assertFalse(page.is_shown("operator"))
        page.driver.execute_script("""
          performance.getEntriesByType('resource').forEach(each => {
            if (each.name.includes('token')) throw new Error(each.name);
          })""")

    def test_an_operator_controls_the_stream(self):
        server = self.serve(*support.STILL, "--tokens", self.list_tokens())
        page = self.browser.touchable(f"{server.link}#token={OPERATOR}")
        page.wait("hapticast.stream.operator && hapticast.stream.viewers === 1", "no number of viewers")
        page.wait("document.getElementById('viewers').innerText === '1 viewer'", "no number is shown")
        if not page.is_shown("panel"):
            page.driver.find_element("id", "panel-button").click()
        self.assertTrue(page.is_shown("operator"))
        page.driver.find_element("id", "operator-pause").click()
        server.wait_for("(?i)pause")
        page.wait("hapticast.report.lookup === 'held' || hapticast.report.lookup === 'faded'",
                  "the stream is not paused")
        page.driver.find_element("id", "operator-play").click()
        page.wait("hapticast.report.lookup === 'interpolated'", "the stream does not go on")
        self.move("operator-seek", 1.5)
        server.wait_for("(?i)(seek|1.5 s)")
        self.move("material-stiffness_N_mm", 1.2)
        server.wait_for(r"(?i)stiffness|material")
        page.shoot("operator")

    def test_an_operator_sees_the_act_of_another(self):
        server = self.serve(*support.STILL, "--tokens", self.list_tokens())
        page = self.browser.touchable(f"{server.link}#token={OPERATOR}")
        page.wait("hapticast.stream.operator", "the page is no operator's")
        if not page.is_shown("panel"):
            page.driver.find_element("id", "panel-button").click()
        self.assertFalse(page.is_shown("operator-act"))
        token = OPERATOR.encode()
        content = b"\x08\x03\x12\x04Anna\x2a" + bytes([len(token)]) + token
        hello, pause = b"\x0a" + bytes([len(content)]) + content, b"\x72\x02\x08\x01"
        page.driver.execute_script("""
          const link = window.anna = new WebSocket(arguments[0], 'hapticast.3');
          const messages = arguments[1];
          link.onopen = () => messages.forEach(bytes => link.send(new Uint8Array(bytes)));""",
                                   server.link.replace("http", "ws", 1) + "stream", [list(hello), list(pause)])
        shown = "document.getElementById('operator-act').innerText"
        page.wait(f"/^Anna paused, \\d+ s ago$/.test({shown})", "the act of the other operator is not shown")
        first = page.text("operator-act")
        page.wait(f"{shown} !== {first!r}", "the age of the act stands still")
        page.shoot("operator-act")

    def move(self, name, value):
        self.browser.driver.execute_script(
            f"const e = document.getElementById('{name}'); e.value = {value};"
            "e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'))")


if __name__ == "__main__":
    support.main()
