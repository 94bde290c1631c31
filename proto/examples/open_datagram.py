#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Opens the sealed datagram of proto/datagrams.md with read_stream.py, which shares no code with hapticast.

    open_datagram.py SEALED.hex PLAIN.hex

The files have the two worked examples as hex. Their payloads have to be the same. It also checks that no changed bit,
no second arrival and no other key passes. It ends with 1 at the first failure, with 77 where a library is missing.
"""
import sys

try:
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
except ImportError:
    print("skipped: cryptography is missing (python3-cryptography)")
    sys.exit(77)
sys.dont_write_bytecode = True  # no folder beside the sources
from read_stream import Keys, field, fields  # noqa: E402

VERIFYING_KEY = bytes.fromhex("03a107bff3ce10be1d70dd18e74bc09967e4d6309ba50d5f1ddc8664125531b8")
SEAL_KEY = bytes(range(0xA0, 0xB0))


def require(holds, what):
    if not holds:
        sys.exit("wrong: " + what)


def keys_of(key=SEAL_KEY, id=7):
    return Keys(fields(field(9, field(1, id) + field(2, key) + field(3, 10000))))


def main():
    sealed, plain = (bytes.fromhex(open(name).read()) for name in sys.argv[1:3])
    for data in (sealed, plain):
        try:
            Ed25519PublicKey.from_public_bytes(VERIFYING_KEY).verify(data[-64:], data[8:-64])
        except InvalidSignature:
            sys.exit("wrong: a signature")
    keys = keys_of()
    payload = keys.open(sealed)
    require(payload == plain[37:-64], "the payload")
    require(keys.open(sealed) is None, "a datagram that comes twice passes")
    require(keys.open(plain) is None, "a plain datagram of a sealed stream passes")
    require(Keys({}).open(plain) == payload, "a stream without a key")
    require(Keys({}).open(sealed) is None, "a sealed datagram of a stream without a key passes")
    require(keys_of(bytes(16)).open(sealed) is None, "another key opens it")
    require(keys_of(id=8).open(sealed) is None, "another id opens it")
    for bit in range(64, 8 * (len(sealed) - 64)):
        changed = bytearray(sealed)
        changed[bit // 8] ^= 1 << bit % 8
        require(keys_of().open(bytes(changed)) is None, f"a datagram with another bit {bit} passes")
    keys = keys_of()
    keys.add(field(1, 8) + field(2, bytes(16)) + field(3, 0))
    require(keys.open(sealed) is None, "a key that has expired opens it")
    objects = fields(payload)[4]
    print(f"opened: {len(payload)} bytes, {len(objects)} object")


if __name__ == "__main__":
    main()
