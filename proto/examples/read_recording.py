#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads a recording of hapticast (recording.md) with python3-protobuf and numpy alone.

    read_recording.py FILE.mcap                    prints the channels, and what the objects did
    read_recording.py FILE.mcap --pictures FOLDER  writes the pictures as FOLDER/000000.jpg, ...

The schemas of the messages stand in the file, so the reader needs no .proto file. A file that was cut off is read up to
its last whole chunk.
"""
import argparse
import pathlib
import struct
import sys
import zlib

try:
    import numpy as np
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
except ImportError as missing:
    print(f"skipped: {missing} (python3-numpy, python3-protobuf)")
    sys.exit(77)

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 3, 4, 5, 6, 15


def read_records(data, begin, end):
    """Yields (code, content) of each whole record."""
    while begin + 9 <= end:
        code, length = struct.unpack_from("<BQ", data, begin)
        if length > end - begin - 9:
            return
        yield code, data[begin + 9:begin + 9 + length]
        begin += 9 + length


def read_text(content, begin):
    """Returns the text at `begin`, and where it ends."""
    length, = struct.unpack_from("<I", content, begin)
    return content[begin + 4:begin + 4 + length], begin + 4 + length


def make_message_class(name, descriptors):
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptors).file:
        pool.Add(file)
    descriptor = pool.FindMessageTypeByName(name)
    if hasattr(message_factory, "GetMessageClass"):
        return message_factory.GetMessageClass(descriptor)
    return message_factory.MessageFactory(pool).GetPrototype(descriptor)  # protobuf before 4.22


def read_messages(data):
    """Yields (topic, time in ns, message) of each message, in the order of the file."""
    if data[:8] != MAGIC:
        raise SystemExit("this is no MCAP file")
    classes, channels = {}, {}

    def read(records):
        for code, content in records:
            if code == CHUNK:
                size, crc = struct.unpack_from("<QI", content, 16)
                compression, at = read_text(content, 28)
                if compression:
                    raise SystemExit(f"the chunks have the compression {compression.decode()}: `mcap convert` removes it")
                chunk = content[at + 8:]
                if len(chunk) != size or crc not in (0, zlib.crc32(chunk)):  # 0: not stated
                    raise SystemExit("a chunk is damaged")
                yield from read(read_records(chunk, 0, size))
            elif code == SCHEMA:
                name, at = read_text(content, 2)
                _, at = read_text(content, at)
                descriptors, _ = read_text(content, at)
                classes[content[:2]] = make_message_class(name.decode(), descriptors)
            elif code == CHANNEL:
                topic, _ = read_text(content, 4)
                channels[content[:2]] = topic.decode(), classes[content[2:4]]
            elif code == MESSAGE:
                topic, message_class = channels[content[:2]]
                yield topic, struct.unpack_from("<Q", content, 6)[0], message_class.FromString(content[22:])
            elif code == DATA_END:
                return

    yield from read(read_records(data, 8, len(data)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--pictures", metavar="FOLDER", type=pathlib.Path)
    arguments = parser.parse_args()
    times, motions, pictures = {}, {}, 0
    for topic, time_ns, message in read_messages(pathlib.Path(arguments.file).read_bytes()):
        times.setdefault(topic, []).append(time_ns)
        if topic == "/frame":
            for each in message.objects:
                at = each.motion.position_mm
                motions.setdefault(each.id, []).append((1e-9 * message.media_time_ns, at.x, at.y, at.z))
        elif topic == "/picture" and arguments.pictures:
            arguments.pictures.mkdir(exist_ok=True)
            (arguments.pictures / f"{pictures:06}.jpg").write_bytes(message.data)
            pictures += 1
    for topic, each in times.items():
        each = 1e-9 * np.array(each)
        print(f"{topic}: {len(each)} messages from {each.min():.3f} s to {each.max():.3f} s")
    for object_id, rows in motions.items():
        rows = np.array(rows)
        path_mm = np.linalg.norm(np.diff(rows[:, 1:], axis=0), axis=1).sum()
        print(f"object {object_id}: {len(rows)} frames, a path of {path_mm:.1f} nominal mm")


if __name__ == "__main__":
    main()
