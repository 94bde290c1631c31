# SPDX-License-Identifier: MIT
"""axe-core (npm) finds nothing wrong in the states of the page."""

import json
import pathlib

import support

AXE = pathlib.Path(support.AXE)


class Accessibility(support.BallTest):

    def check(self, name):
        """Reports each rule of axe-core that the page breaks."""
        driver = self.browser.driver
        if not driver.execute_script("return Boolean(window.axe)"):
            driver.execute_script(AXE.read_text(encoding="utf-8"))
        result = driver.execute_async_script(
            "const done = arguments[0];"
            "axe.run({resultTypes: ['violations']}).then(done, error => done({problem: `${error}`}))")
        self.assertNotIn("problem", result)
        self.assertGreater(len(result["passes"]), 10)
        broken = [{"rule": each["id"], "at": [node["html"] for node in each["nodes"]][:5],
                   "why": each["nodes"][0]["failureSummary"]} for each in result["violations"]]
        self.assertEqual(broken, [], f"{name}: {json.dumps(broken, indent=1)}")

    def test_connected_and_in_contact(self):
        page = self.browser.touchable(self.server.link)
        self.check("connected")
        at = page.place()
        page.mouse("Moved", at)
        page.press(at)
        page.wait_for_force()
        self.check("in contact")

    def test_panel_and_help(self):
        for scheme in ("dark", "light"):
            self.browser.command("Emulation.setEmulatedMedia",
                                 features=[{"name": "prefers-color-scheme", "value": scheme}])
            page = self.browser.touchable(self.server.link)
            if not page.is_shown("panel"):
                page.get("document.getElementById('panel-button').click()")
            page.get("document.querySelectorAll('details').forEach(each => each.open = true)")
            self.check(f"panel, {scheme}")
            page.get("document.getElementById('help-button').click()")
            self.check(f"help, {scheme}")

    def test_failed(self):
        page = self.browser.open(f"{self.server.link}#origin-key={'0' * 64}")
        page.wait_for_state("failed")
        self.check("failed")

    def test_on_a_phone(self):
        self.browser.set_screen(320, 568, touch=True)
        self.browser.touchable(self.server.link)
        self.check("phone")


if __name__ == "__main__":
    support.main("" if AXE.exists() else
                 f"axe-core was not found in {AXE}: npm install --prefix build/npm axe-core@4.14.1")
