# SPDX-License-Identifier: MIT
"""A folder of `hapticast-server bake` on web servers: nginx, which answers ranges; Python's own, which does not; and
servers that answer wrongly."""

import functools
import http.server
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import threading
import unittest

import support

NGINX = """
daemon off; {user} pid {folder}/pid; error_log {folder}/error.log; worker_processes 1;
events {{}}
http {{
  access_log {folder}/access.log; include /etc/nginx/mime.types;
  client_body_temp_path {folder}; proxy_temp_path {folder}; fastcgi_temp_path {folder}; uwsgi_temp_path {folder};
  scgi_temp_path {folder};
  server {{ listen 127.0.0.1:{port}; root {root}; }}
}}
"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Python's web server, which ignores ranges."""

    def log_message(self, *_):
        pass


class WrongRanges(Quiet):
    """Says that it answers ranges, and sends the begin of the file for each."""

    def send_head(self):
        if not self.path.endswith(".mcap"):
            return super().send_head()
        size = pathlib.Path(self.translate_path(self.path)).stat().st_size
        begin, end = self.headers["Range"].removeprefix("bytes=").split("-")
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {begin}-{end}/{size}")
        length = 1 if end == "0" else (int(end) - int(begin) + 1) // 2
        self.send_header("Content-Length", str(length))
        self.end_headers()
        self.wfile.write(b"\x89" * length)
        return None


class WithoutTypes(Quiet):
    """Does not know the type of scripts."""

    extensions_map = {**http.server.SimpleHTTPRequestHandler.extensions_map, ".js": "text/plain"}


class Folder(support.PageTest):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.work = tempfile.TemporaryDirectory(prefix="hapticast-folder-")
        cls.addClassCleanup(cls.work.cleanup)
        cls.folder = pathlib.Path(cls.work.name, "page")
        subprocess.run([support.SERVER, "bake", "synthetic:still", "--map-range", "520,620", "--frames", "60", "--quiet",
                        "-o", f"{cls.folder}/"], check=True)

    def serve_by(self, handler, folder=None):
        """Serves the folder by a handler of Python; returns its link."""
        server = http.server.ThreadingHTTPServer(
            ("127.0.0.1", 0), functools.partial(handler, directory=str(folder or self.folder)))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        return f"http://127.0.0.1:{server.server_address[1]}/"

    def serve_by_nginx(self):
        """Starts nginx; returns its link and the file of its requests."""
        work = tempfile.TemporaryDirectory(prefix="hapticast-nginx-")
        self.addCleanup(work.cleanup)
        # nginx listens at no port of the kernel's choice, but takes over a socket, as from a nginx before it.
        listener = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(listener.close)
        port = listener.getsockname()[1]
        config = pathlib.Path(work.name, "nginx.conf")
        config.write_text(NGINX.format(
            folder=work.name, root=self.folder, port=port, user="user root;" if os.geteuid() == 0 else ""), encoding="utf-8")
        # pylint: disable-next=consider-using-with
        process = subprocess.Popen(
            ["/usr/sbin/nginx", "-c", str(config)], stderr=subprocess.DEVNULL, pass_fds=[listener.fileno()],
            env={**os.environ, "NGINX": f"{listener.fileno()};"})
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        support.wait_until(lambda: pathlib.Path(work.name, "pid").exists(), "nginx does not start")
        return f"http://127.0.0.1:{port}/", pathlib.Path(work.name, "access.log")

    def press(self):
        page = self.browser
        at = page.place()
        page.mouse("Moved", at)
        page.press(at)
        page.wait_for_force()

    def seek(self):
        """Seeks by the keyboard, and waits until the place follows."""
        page = self.browser
        page.driver.execute_script(
            "const place = document.getElementById('place'); place.value = place.max * 0.8;"
            "place.dispatchEvent(new Event('input')); place.dispatchEvent(new Event('change'));")
        page.wait("hapticast.stream.timeline.position_s > 0.5", "the place does not follow")

    def test_python(self):
        self.browser.touchable(self.serve_by(Quiet))
        self.assertEqual(self.browser.get("hapticast.stream.signature"), "unsigned")
        self.assertGreater(self.browser.get("hapticast.stream.timeline.length_s"), 2)
        self.press()
        self.seek()

    @unittest.skipUnless(shutil.which("nginx") or pathlib.Path("/usr/sbin/nginx").exists(), "nginx was not found")
    def test_nginx(self):
        link, log = self.serve_by_nginx()
        self.browser.touchable(link)
        self.press()
        self.seek()
        ranges = [line for line in log.read_text(encoding="utf-8").splitlines() if ".mcap" in line]
        self.assertGreater(sum(" 206 " in line for line in ranges), 2)
        self.assertFalse([line for line in ranges if " 200 " in line], "the whole file")

    def test_wrong_ranges(self):
        self.browser.open(self.serve_by(WrongRanges))
        self.browser.wait_for_state("failed")
        self.assertIn("ranges", self.browser.text("card-text"))

    def test_scripts_of_a_wrong_type(self):
        self.browser.driver.get(self.serve_by(WithoutTypes))
        support.wait_until(lambda: "text/javascript" in self.browser.text("no-scripts"), "no sentence")
        self.browser.touchable(self.serve_by(Quiet))
        self.assertFalse(self.browser.driver.find_elements("id", "no-scripts"), "the scripts run")

    def test_a_cut_recording(self):
        cut = pathlib.Path(self.work.name, "cut")
        shutil.copytree(self.folder, cut)
        whole = (cut / "recording.mcap").read_bytes()
        (cut / "recording.mcap").write_bytes(whole[:len(whole) // 2])
        self.browser.touchable(self.serve_by(Quiet, cut))
        self.browser.wait("hapticast.report.states?.includes('cut off') || "
                          "document.getElementById('states').innerText.includes('cut off')", "the damage is not named")

    def test_no_recording(self):
        empty = pathlib.Path(self.work.name, "empty")
        shutil.copytree(self.folder, empty)
        (empty / "recording.mcap").unlink()
        self.browser.open(self.serve_by(Quiet, empty))
        self.browser.wait_for_state("failed")
        self.assertIn("404", self.browser.text("card-text"))


if __name__ == "__main__":
    support.main()
