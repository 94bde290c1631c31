# SPDX-License-Identifier: MIT
"""What stands between a page and its server, or in its place: each answers wrongly in one way.

`Between` passes all bytes on, but those of `/stream` through its method `relay`. So the page itself
always comes from the real server.
"""

import base64
import hashlib
import socket
import struct
import threading
import time

HELD_BYTES = 64 << 10
HELD_S = 0.3


def make_frame(opcode, payload, length=None):
    """Returns a frame of a WebSocket. `length`: the one that its head claims."""
    length = len(payload) if length is None else length
    if length < 126:
        size = struct.pack("!B", length)
    elif length < 1 << 16:
        size = struct.pack("!BH", 126, length)
    else:
        size = struct.pack("!BQ", 127, length)
    return struct.pack("!B", 0x80 | opcode) + size + payload


def accept(head, protocol="hapticast.3"):
    """Returns the answer that opens the WebSocket of a request."""
    key = next(line.split(b": ", 1)[1] for line in head.split(b"\r\n")
               if line.lower().startswith(b"sec-websocket-key: "))
    digest = hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest()
    return (b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Accept: " + base64.b64encode(digest) +
            f"\r\nSec-WebSocket-Protocol: {protocol}\r\n\r\n".encode())


class Between:
    """A program between the page and the server on `port`. `streams` counts the upgrades."""

    def __init__(self, port):
        self.server_port = port
        self.streams = 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.link = f"http://127.0.0.1:{self.port}/"
        threading.Thread(target=self.listen, daemon=True).start()

    def stop(self):
        self.listener.close()

    def listen(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def serve(self, browser):
        head = b""
        with browser:
            while b"\r\n\r\n" not in head:
                part = browser.recv(4096)
                if not part:
                    return
                head += part
            try:
                if head.startswith(b"GET /stream "):
                    self.streams += 1
                    self.answer(browser, head)
                else:
                    self.relay(browser, head, pass_on)
            except OSError:
                pass  # the page has closed its connection

    def answer(self, browser, head):
        """Answers the upgrade."""
        raise NotImplementedError

    def relay(self, browser, head, to_browser):
        """Connects the browser with the server; `to_browser(server, browser)` passes answers on."""
        with socket.create_connection(("127.0.0.1", self.server_port)) as server:
            server.sendall(head)
            threading.Thread(target=pass_on, args=(browser, server), daemon=True).start()
            to_browser(server, browser)


def pass_on(source, sink):
    try:
        while part := source.recv(1 << 16):
            sink.sendall(part)
        sink.shutdown(socket.SHUT_WR)
    except OSError:
        pass


def hold(source, sink):
    """Passes bytes on in blocks of 64 kB, or each 300 ms."""
    source.settimeout(0.05)
    held, since = b"", time.monotonic()
    while True:
        try:
            part = source.recv(1 << 16)
            if not part:
                break
            held += part
        except TimeoutError:
            pass
        if len(held) >= HELD_BYTES or time.monotonic() - since >= HELD_S:
            sink.sendall(held)
            held, since = b"", time.monotonic()


class Buffering(Between):
    def answer(self, browser, head):
        self.relay(browser, head, hold)


class Refusing(Between):
    """Answers the upgrade as an ordinary web server."""

    def answer(self, browser, head):
        browser.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\nConnection: close\r\n\r\nhi")


class Silent(Between):
    """Accepts the connection and answers nothing."""

    def answer(self, browser, head):
        while browser.recv(1 << 16):
            pass


class Sending(Between):
    """Opens the WebSocket and sends `frames`, in the server's place."""

    def __init__(self, port, frames, protocol="hapticast.3"):
        self.frames = frames
        self.protocol = protocol
        super().__init__(port)

    def answer(self, browser, head):
        browser.sendall(accept(head, self.protocol) + self.frames)
        while browser.recv(1 << 16):
            pass


class Cutting(Between):
    """Ends the stream in the middle of a frame, after `size` bytes."""

    def __init__(self, port, size):
        self.size = size
        super().__init__(port)

    def answer(self, browser, head):
        def cut(server, browser):
            left = self.size
            while left > 0 and (part := server.recv(min(left, 1 << 16))):
                browser.sendall(part)
                left -= len(part)
        self.relay(browser, head, cut)
