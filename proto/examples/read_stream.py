#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A client of a hapticast server in plain Python, as proto/README.md describes it, to be read beside that page. It
shares no code with hapticast's own and needs no protobuf library; numpy, and to check signatures (--udp must)
python3-cryptography.

    read_stream.py [HOST[:PORT]] [--tls [--fingerprint SHA256]] [--udp] [--frames N] [--out DIR]

takes N frames (25), over TCP or by signed datagrams, prints what is in the last one and writes each of its objects'
reliefs as DIR/object_ID_LAYER.png: the whole picture in 16 bits of grey, a thousandth of a mm each, 0 outside.
--tls encrypts the connection, and then datagrams are sealed. --fingerprint is the SHA-256 of the server's certificate
in hex. Without it any certificate will do, and whoever is on the way can read and change everything.
"""
import argparse
import hashlib
import os
import select
import socket
import ssl
import struct
import sys
import time
import zlib

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing (python3-numpy)")
    sys.exit(77)
sys.dont_write_bytecode = True  # no folder beside the sources
from read_slices import read_slice  # noqa: E402

GIVE_UP_S = 30.0


# Protobuf: a message is fields, a field is a tag (number * 8 + kind) and a value.
def varint(data, at):
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift += 7
        at += 1
        if data[at - 1] < 128:
            return value & (1 << 64) - 1, at


def fields(data):
    """All fields of a message, by number: kind 0 as integers, kinds 1, 2 and 5 as bytes."""
    found, at = {}, 0
    while at < len(data):
        tag, at = varint(data, at)
        kind = tag & 7
        if kind == 0:
            value, at = varint(data, at)
        else:
            size = {1: 8, 5: 4}.get(kind)
            if kind == 2:
                size, at = varint(data, at)
            if size is None or at + size > len(data):
                raise ValueError("not a message")
            value, at = data[at:at + size], at + size
        found.setdefault(tag >> 3, []).append(value)
    return found


def one(message, number, default=0):
    return message[number][-1] if number in message else default


def field(number, value):
    """A field of an integer or of bytes."""
    def coded(n):
        return bytes([n]) if n < 128 else bytes([n & 127 | 128]) + coded(n >> 7)
    if isinstance(value, int):
        return coded(number << 3) + coded(value)
    return coded(number << 3 | 2) + coded(len(value)) + value


class Objects:
    """The objects of a frame, as messages or pieces of messages that came in any order."""

    def __init__(self):
        self.heads, self.slices, self.rects = {}, {}, {}

    def add(self, message):
        content = fields(message)
        key = one(content, 1), one(content, 2)
        if not one(content, 8):
            self.heads[key] = content
        if 4 in content:
            relief = fields(one(content, 4))
            self.rects[key] = tuple(one(relief, n) for n in (1, 2, 3, 4))
            self.slices.setdefault(key, []).extend(relief.get(9, []))


class Reliefs:
    """What was sent last of each object's relief: unchanged ones are left out of most frames."""

    def __init__(self):
        self.known = {}

    def keep(self, objects):
        for key, head in objects.heads.items():
            if key in objects.rects:
                self.known[key] = one(head, 3), objects.rects[key], objects.slices[key]
        return [key for key, head in objects.heads.items()
                if key in self.known and self.known[key][0] == one(head, 3)]

    def picture(self, key, width, height):
        """Heights in units of 1/4096 mm and the mask, in the whole picture."""
        _, (u, v, w, h), slices = self.known[key]
        mask, heights = np.zeros((height, width), np.uint8), np.zeros((height, width), np.int64)
        for data in slices:
            x, y, part, units = read_slice(data, w, h)
            at = np.s_[v + y:v + y + part.shape[0], u + x:u + x + part.shape[1]]
            mask[at], heights[at] = part, units
        return heights, mask


def write_png(path, grey):
    """16 bits a pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in grey)
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", grey.shape[1], grey.shape[0], 16, 0, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def key_fingerprint(certificate):
    """SHA-256 of the public key in a certificate (DER), as the server logs it."""
    from cryptography import x509
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat
    key = x509.load_der_x509_certificate(certificate).public_key()
    return hashlib.sha256(key.public_bytes(Encoding.DER, PublicFormat.SubjectPublicKeyInfo)).hexdigest()


def encrypt(plain, fingerprint):
    """TLS 1.3 over a connection. The certificate is judged by the fingerprint of its key alone."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    tls = context.wrap_socket(plain)
    seen = key_fingerprint(tls.getpeercert(binary_form=True))
    if fingerprint and seen != fingerprint.lower().replace(":", ""):
        sys.exit(f"the server's key has another fingerprint: {seen}")
    return tls


class Connection:
    """The TCP connection: messages behind their lengths."""

    def __init__(self, host, port, on_tcp, tls=False, fingerprint=None):
        self.socket = socket.create_connection((host, port), timeout=GIVE_UP_S)
        if tls:
            self.socket = encrypt(self.socket, fingerprint)
        self.buffer, self.pinged = b"", 0.0
        self.send(1, field(1, 3) + field(2, b"read_stream.py") + field(4, int(on_tcp)))

    def send(self, kind, content):
        message = field(kind, content)
        self.socket.sendall(struct.pack("<I", len(message)) + message)

    def ping(self):
        if time.monotonic() - self.pinged >= 1.0:
            self.pinged = time.monotonic()
            self.send(3, b"\x09" + struct.pack("<q", time.monotonic_ns()))

    def read(self):
        """The next whole message as (kind, content), None where more bytes are needed."""
        if len(self.buffer) < 4:
            return None
        size = struct.unpack("<I", self.buffer[:4])[0]
        if not 1 <= size <= 8 << 20:
            sys.exit("not a hapticast server")
        if len(self.buffer) < 4 + size:
            return None
        message, self.buffer = self.buffer[4:4 + size], self.buffer[4 + size:]
        content = fields(message)
        signature = one(content, 12, b"")
        content.pop(12, None)
        [(kind, [content])] = content.items()
        if kind == 9:
            sys.exit("the server says: " + one(fields(content), 2, b"").decode())
        if kind == 2:
            self.welcome = fields(content)
        if kind == 6 and not self.genuine(content, signature):
            sys.exit("a frame has no valid signature")
        return kind, content

    def genuine(self, frame, signature):
        """Whether a frame has the signature of the welcome's key. Without a key, or without the library, any frame has."""
        try:
            from cryptography.exceptions import InvalidSignature
            from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
        except ImportError:
            return True
        if 7 not in self.welcome:
            return True
        key = Ed25519PublicKey.from_public_bytes(one(self.welcome, 7))
        try:
            key.verify(signature, one(self.welcome, 6, bytes(4)) + frame)
        except InvalidSignature:
            return False
        return True

    def receive(self):
        while True:
            data = self.socket.recv(1 << 16)
            if not data:
                sys.exit("the server has closed the connection")
            self.buffer += data
            if not (isinstance(self.socket, ssl.SSLSocket) and self.socket.pending()):
                return  # what TLS has decrypted already would not wake select()


class Keys:
    """The keys of sealed datagrams by id, each with its expiry and the counters that have come."""

    WINDOW = 32768

    def __init__(self, welcome):
        self.known = {}
        if 9 in welcome:
            self.add(one(welcome, 9))

    def add(self, message):
        from cryptography.hazmat.primitives.ciphers.aead import AESGCM
        content = fields(message)
        expires = time.monotonic() + one(content, 3) / 1000
        self.known = {id: (key, min(until, expires), seen) for id, (key, until, seen) in self.known.items()}
        self.known[one(content, 1)] = AESGCM(one(content, 2)), float("inf"), set()

    def open(self, data):
        """The payload of a datagram whose signature is valid, None where it has to be dropped."""
        from cryptography.exceptions import InvalidTag
        id, parts = data[12], data[35:37]
        if id == 0:  # plain: a probe, or a stream that is not sealed
            return data[37:-64] if not self.known or parts == bytes(2) else None
        if id not in self.known or parts == bytes(2) or len(data) < 125:
            return None
        key, until, seen = self.known[id]
        counter = struct.unpack("<Q", data[37:45])[0]
        newest = max(seen, default=counter)
        if time.monotonic() >= until or counter in seen or counter + self.WINDOW <= newest:
            return None
        try:
            payload = key.decrypt(bytes(4) + data[37:45], data[45:-64], data[8:45])
        except InvalidTag:
            return None
        seen.add(counter)
        if len(seen) > 2 * self.WINDOW:
            seen.intersection_update(range(newest - self.WINDOW, newest + self.WINDOW))
        return payload


class Datagrams:
    """The UDP socket: echoes, and frames from signed pieces."""

    def __init__(self, connection, welcome):
        from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
        self.token = struct.unpack("<Q", one(welcome, 3, bytes(8)))[0]
        if self.token == 0:
            sys.exit("this server sends no datagrams")
        self.stream = struct.unpack("<I", one(welcome, 6, bytes(4)))[0]
        self.key = Ed25519PublicKey.from_public_bytes(one(welcome, 7))
        self.keys = Keys(welcome)
        host, port, *zone = connection.socket.getpeername()
        self.server = (host, one(welcome, 5) or port, *zone)
        local = connection.socket.getsockname()
        self.socket = socket.socket(connection.socket.family, socket.SOCK_DGRAM)
        self.socket.bind((local[0], 0, *local[2:]))
        self.socket.setblocking(False)
        self.frames, self.echoed, self.probes, self.refused, self.verified = {}, 0.0, 0, 0, 0

    def echo(self):
        if time.monotonic() - self.echoed >= (10.0 if self.probes else 0.2):
            self.echoed = time.monotonic()
            self.socket.sendto(struct.pack("<QI", self.token, self.stream), self.server)

    def genuine(self, data):
        from cryptography.exceptions import InvalidSignature
        try:
            self.key.verify(data[-64:], data[8:-64])
        except InvalidSignature:
            return False
        return True

    def receive(self):
        """The objects of a frame that has become whole, if one has."""
        data = self.socket.recv(2048)
        if not 101 <= len(data) <= 1232:
            self.refused += 1
            return None
        token, stream, _, _, frame, _, part, parts = struct.unpack("<QIBIQqHH", data[:37])
        payload = None
        if token == self.token and stream == self.stream and self.genuine(data):
            payload = self.keys.open(data)
        if payload is None:
            self.refused += 1
            return None
        self.verified += 1
        if parts == 0:
            self.probes += 1
            return None
        had, objects = self.frames.setdefault(frame, (set(), Objects()))
        if part not in had:
            had.add(part)
            for message in fields(payload).get(4, []):
                objects.add(message)
        if len(had) < parts:
            return None
        self.frames = {id: each for id, each in self.frames.items() if id > frame}  # older ones come too late
        return objects


def receive(connection, udp, wanted):
    """Takes so many frames; the picture's size, the last frame's objects, and all reliefs."""
    reliefs, size, datagrams, objects, frames = Reliefs(), None, None, None, 0
    deadline = time.monotonic() + GIVE_UP_S
    while frames < wanted:
        connection.ping()
        if datagrams:
            datagrams.echo()
        sockets = [connection.socket] + ([datagrams.socket] if datagrams else [])
        ready = select.select(sockets, [], [], 0.1)[0]
        if time.monotonic() > deadline:
            sys.exit(f"only {frames} frames came in {GIVE_UP_S:g} s")
        whole = []
        if connection.socket in ready:
            connection.receive()
        while (message := connection.read()) is not None:
            kind, content = message
            if kind == 2:  # a second one: another server makes the stream
                reliefs = Reliefs()
            if kind == 2 and udp:
                datagrams = Datagrams(connection, fields(content))
            if kind == 13 and datagrams:
                datagrams.keys.add(content)
            if kind in (2, 5):
                description = fields(content if kind == 5 else one(fields(content), 4))
                size = one(description, 2), one(description, 3)
            if kind == 6:
                whole.append(Objects())
                for each in fields(content).get(4, []):
                    whole[-1].add(each)
        if datagrams and datagrams.socket in ready:
            frame = datagrams.receive()
            whole += [frame] if frame else []
        for objects in whole:
            frames += 1
            touchable = reliefs.keep(objects)
    if datagrams:
        print(f"{datagrams.verified} datagrams verified, {datagrams.refused} refused, {datagrams.probes} probes")
    return size, objects, touchable, reliefs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("server", nargs="?", default="127.0.0.1:7447")
    parser.add_argument("--tls", action="store_true")
    parser.add_argument("--fingerprint")
    parser.add_argument("--udp", action="store_true")
    parser.add_argument("--frames", type=int, default=25)
    parser.add_argument("--out")
    arguments = parser.parse_args()
    if arguments.udp:
        try:
            import cryptography
        except ImportError:
            print("skipped: cryptography is missing (python3-cryptography)")
            sys.exit(77)
    host, _, port = arguments.server.rpartition(":") if ":" in arguments.server else (arguments.server, "", "7447")
    connection = Connection(host.strip("[]"), int(port), not arguments.udp, arguments.tls, arguments.fingerprint)
    (width, height), objects, touchable, reliefs = receive(connection, arguments.udp, arguments.frames)
    for key in touchable:
        heights, mask = reliefs.picture(key, width, height)
        motion = fields(one(objects.heads[key], 5, b""))
        place = [struct.unpack("<f", one(fields(one(motion, 1, b"")), n, bytes(4)))[0] for n in (1, 2, 3)]
        inside = heights[mask != 0] / 4096
        print(f"object {key[0]} layer {key[1]}: {inside.size} px, {inside.min():.3f} to {inside.max():.3f} mm high, "
              f"at ({place[0]:.1f}, {place[1]:.1f}, {place[2]:.1f}) mm")
        if arguments.out:
            os.makedirs(arguments.out, exist_ok=True)
            write_png(f"{arguments.out}/object_{key[0]}_{key[1]}.png",
                      np.where(mask != 0, np.clip(heights * 1000 // 4096, 1, 65535), 0))


if __name__ == "__main__":
    main()
