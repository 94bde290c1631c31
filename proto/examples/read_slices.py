#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Decodes slices of reliefs as proto/slices.md describes them: a second implementation in plain integers,
which shares no code with hapticast's own, to be read beside that page.

    read_slices.py FILE...    checks files of slices: lines `rect WIDTH HEIGHT`, `slice HEX`, then `crc MASK HEIGHTS`
"""
import sys
import zlib

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing (python3-numpy)")
    sys.exit(77)

HIGHEST = 1 << 22  # units of 1/4096 mm


class Bit:
    def __init__(self):
        self.p = 32768
        self.n = 0

    def learn(self, one):
        rate = 655360 // (10 * self.n + 16)
        self.p += -(self.p * rate >> 16) if one else (65535 - self.p) * rate >> 16
        self.p = max(96, min(65440, self.p))
        self.n = min(self.n + 1, 32)


class RangeDecoder:
    def __init__(self, data):
        self.data = data
        self.next = 0
        self.range = 0xFFFFFFFF
        self.code = 0
        for _ in range(4):
            self.code = self.code << 8 | self.byte()

    def byte(self):
        self.next += 1
        return self.data[self.next - 1] if self.next <= len(self.data) else 0

    def refill(self):
        while self.range < 1 << 24:
            self.range = self.range << 8 & 0xFFFFFFFF
            self.code = (self.code << 8 | self.byte()) & 0xFFFFFFFF

    def bit(self, model, other=None):
        zero = model.p >> 1 if other is None else (model.p + other.p) >> 2
        bound = (self.range >> 15) * zero
        one = self.code >= bound
        if one:
            self.code -= bound
            self.range -= bound
        else:
            self.range = bound
        model.learn(one)
        if other is not None:
            other.learn(one)
        self.refill()
        return int(one)

    def raw(self):
        self.range >>= 1
        one = self.code >= self.range
        if one:
            self.code -= self.range
        self.refill()
        return int(one)


class Number:
    def __init__(self):
        self.zero, self.sign = Bit(), Bit()
        self.exponent = [Bit() for _ in range(23)]
        self.mantissa = [Bit() for _ in range(23)]


class Place:
    def __init__(self):
        self.zero = Bit()
        self.exponent = [Bit() for _ in range(8)]


def magnitude(coder, model, place=None):
    e = 0
    while e < 22 and coder.bit(model.exponent[e], place.exponent[e] if place is not None and e < 8 else None):
        e += 1
    value = 1
    for i in range(e):
        value = value << 1 | (coder.bit(model.mantissa[e]) if i == 0 else coder.raw())
    return value


def number(coder, model):
    if not coder.bit(model.zero):
        return 0
    minus = coder.bit(model.sign)
    value = magnitude(coder, model)
    return -value if minus else value


def read_mask(coder, width, height):
    away, passed = [Bit() for _ in range(6)], [Bit(), Bit()]
    shift, run = [Number() for _ in range(6)], Number()
    mask = np.zeros((height, width), np.uint8)
    above = [(width, 0)]
    for y in range(height):
        row, at, inside, lost, start = [], -1, 0, False, 0
        while at < width:
            follow = [i for i, (where, _) in enumerate(above) if where > at and i % 2 == inside]
            first, moved = above[follow[0]] if follow else (width, 0)
            second = above[follow[0] + 1][0] if follow and follow[0] + 1 < len(above) else width
            k = 5 if lost else max(-2, min(2, moved)) + 2
            d = 0
            if not coder.bit(away[k]):
                d = number(coder, shift[k]) + (moved if abs(moved) >= 2 else 0)
                edge, lost = first + d, False
            else:
                lost = True
                if coder.bit(passed[inside]):
                    at = second
                    continue
                edge = at + magnitude(coder, run)
            edge = min(width, max(edge, 0, at + 1))
            if inside:
                mask[y, start:edge] = 1
            row.append((edge, max(-7, min(7, d))))
            start = at = edge
            inside = 1 - inside
        if not row or row[-1][0] != width:
            if inside:
                mask[y, start:] = 1
            row.append((width, 0))
        above = row[:-1] + [(width, 0)]
    return mask


def read_base(coder, occupied, step):
    rows, columns = occupied.shape[0] + 1, occupied.shape[1] + 1
    around = np.pad(occupied, 1)
    needed = around[1:, 1:] | around[:-1, 1:] | around[1:, :-1] | around[:-1, :-1]
    need = np.pad(needed, 2)  # two nodes around, as for `value` and `rest`
    value, rest = np.zeros(need.shape, np.int64), np.zeros(need.shape, np.int64)
    models = [Number() for _ in range(4)]
    most = HIGHEST // step + 1
    for y in range(2, rows + 2):
        for x in range(2, columns + 2):
            if not need[y, x]:
                continue
            guess = 0
            if need[y, x - 1] and need[y - 1, x] and need[y - 1, x - 1]:
                guess = value[y, x - 1] + value[y - 1, x] - value[y - 1, x - 1]
            elif need[y, x - 1]:
                guess = value[y, x - 1]
            elif need[y - 1, x]:
                guess = value[y - 1, x]
            elif need[y - 1, x + 1]:
                guess = value[y - 1, x + 1]
            near = rest[y, x - 1] + rest[y - 1, x]
            r = number(coder, models[0 if near < 2 else 1 if near < 8 else 2 if near < 32 else 3])
            rest[y, x] = min(abs(r), 64)
            value[y, x] = max(-most, min(most, int(guess) + r))
    nodes = value[2:-2, 2:-2] * step
    for y, x in np.argwhere(~needed.astype(bool)):
        found = []
        for dy, dx in ((0, -1), (0, 1), (-1, 0), (1, 0)):
            near, far = (y + 2 + dy, x + 2 + dx), (y + 2 + 2 * dy, x + 2 + 2 * dx)
            if need[near]:
                found.append(int(2 * value[near] - value[far] if need[far] else value[near]) * step)
        if found:
            total = sum(found)
            nodes[y, x] = total // len(found) if total >= 0 else -(-total // len(found))
    return nodes


def between(a):
    """The points between those of the first axis."""
    n = len(a)
    if n == 2:
        return (a[:1] + a[1:]) >> 1
    out = np.empty((n - 1,) + a.shape[1:], np.int64)
    out[0] = (3 * a[0] + 6 * a[1] - a[2] + 4) >> 3
    out[-1] = (3 * a[-1] + 6 * a[-2] - a[-3] + 4) >> 3
    out[1:-1] = (9 * (a[1:-2] + a[2:-1]) - a[:-3] - a[3:] + 8) >> 4
    return out


def woven(a, b):
    out = np.empty((len(a) + len(b),) + a.shape[1:], np.int64)
    out[0::2], out[1::2] = a, b
    return out


def read_details(coder, level, mask, occupied, flags_before, coarser):
    """Details of the points of level 0, 1, 2 (4, 2, 1 px apart), with two points around them; and the cells' flags."""
    px, points = 4 >> level, 2 << level
    rows, columns = occupied.shape
    size = np.zeros((rows * points + 4, columns * points + 4), np.int64)
    value = np.zeros_like(size)
    flags = np.zeros((rows + 1, columns + 1), np.int64)  # a row above and a column to the left
    flag_models = [[Bit() for _ in range(3)] for _ in range(2)]
    numbers = [[Number() for _ in range(5)] for _ in range(2)]
    places = [[Place() for _ in range(12)] for _ in range(2)]
    signs = [[Bit() for _ in range(9)] for _ in range(2)]
    edge = np.pad(mask, 4)
    for cy, cx in np.argwhere(occupied):
        if level > 0:
            before = flags_before[cy + 1, cx + 1] if level == 2 else 0
            flag = coder.bit(flag_models[before][flags[cy + 1, cx] + flags[cy, cx + 1]])
            flags[cy + 1, cx + 1] = flag
            if not flag:
                continue
        for y in range(cy * points, (cy + 1) * points):
            for x in range(cx * points, (cx + 1) * points):
                odd = y & 1
                if (not odd and not x & 1) or not mask[y * px, x * px]:
                    continue
                Y, X = y + 2, x + 2
                s = (size[Y, X - 1] + size[Y, X - 2] + size[Y - 1, X] + size[Y - 2, X] + size[Y - 1, X - 1]
                     + size[Y - 1, X + 1])
                model = numbers[odd][s if s < 3 else 3 if s < 7 else 4]
                v, u = y * px + 4, x * px + 4
                inner = edge[v, u - px] & edge[v, u + px] & edge[v - px, u] & edge[v + px, u]
                busy = 0
                if coarser is not None:
                    around = coarser[y // 2 + 2:y // 2 + 4, x // 2 + 2:x // 2 + 4].sum()
                    busy = 0 if around == 0 else 1 if around < 3 else 2
                place = places[odd][(0 if inner else 6) + (3 if x & odd else 0) + busy]
                if not coder.bit(model.zero, place.zero):
                    continue
                sides = []
                for near, far in ((value[Y, X - 1], value[Y, X - 2]), (value[Y - 1, X], value[Y - 2, X])):
                    v = near or far
                    sides.append(0 if v == 0 else 1 if v < 0 else 2)
                minus = coder.bit(signs[odd][3 * sides[0] + sides[1]])
                m = magnitude(coder, model, place)
                size[Y, X], value[Y, X] = min(m, 60), -m if minus else m
    return value, size, flags


def corrected(heights, change):
    touched = change != 0
    heights[touched] = np.clip(heights[touched] + change[touched], -HIGHEST, HIGHEST)


def read_smooth(coder, mask, columns, rows, step, sixteenths):
    coarse = max(1, step * sixteenths // 16)
    steps = (max(1, 4 * coarse // 5), coarse, step)
    full = np.zeros((rows * 8, columns * 8), np.uint8)
    full[:mask.shape[0], :mask.shape[1]] = mask
    occupied = full.reshape(rows, 8, columns, 8).max(axis=(1, 3))
    heights = read_base(coder, occupied, max(1, 7 * coarse // 10))
    details, size, flags = [], None, None
    for level in range(3):
        value, size, flags = read_details(coder, level, full, occupied, flags, size)
        details.append(value)
    for level in range(3):
        farthest = (1 << 25) // steps[level]
        change = np.clip(details[level][2:-2, 2:-2], -farthest, farthest) * steps[level]
        even = woven(heights.T, between(heights.T)).T
        corrected(even[:-1, :-1], change[0::2])
        odd = between(even)
        corrected(odd[:, :-1], change[1::2])
        heights = woven(even, odd)
    return heights[:mask.shape[0], :mask.shape[1]]


def read_rough(coder, mask, step):
    first, count, change = Number(), Number(), Number()
    levels = [number(coder, first)]
    size, gap = magnitude(coder, count), step
    for _ in range(size - 1):
        gap += number(coder, change)
        levels.append(levels[-1] + gap)
        if gap < 1 or levels[-1] > HIGHEST:
            raise ValueError("levels out of range")
    models = [[Number() for _ in range(3)] for _ in range(7)]
    signs = [Bit() for _ in range(9)]
    height, width = mask.shape
    inside, level = np.pad(mask, 1), np.zeros((height + 2, width + 2), np.int64)
    rest = np.zeros_like(level)
    last = 0
    for y, x in np.argwhere(mask):
        y, x = y + 1, x + 1
        left = level[y, x - 1] if inside[y, x - 1] else level[y - 1, x] if inside[y - 1, x] else last
        up = level[y - 1, x] if inside[y - 1, x] else left
        up_left = level[y - 1, x - 1] if inside[y - 1, x - 1] else up
        up_right = level[y - 1, x + 1] if inside[y - 1, x + 1] else up
        low, high = min(left, up), max(left, up)
        guess = low if up_left >= high else high if up_left <= low else left + up - up_left
        s = abs(up_right - up) + abs(up - up_left) + abs(up_left - left)
        unrest = s if s < 3 else 3 if s < 5 else 4 if s < 9 else 5 if s < 17 else 6
        missed = rest[y, x - 1] + rest[y - 1, x]
        model = models[unrest][0 if missed == 0 else 1 if missed < 3 else 2]
        r = 0
        if coder.bit(model.zero):
            sign = 3 * (np.sign(up - up_left) + 1) + np.sign(left - up_left) + 1
            minus = coder.bit(signs[sign])
            r = magnitude(coder, model)
            r = -r if minus else r
        rest[y, x] = min(abs(r), 60)
        last = level[y, x] = max(0, min(len(levels) - 1, int(guess) + r))
    return np.array(levels, np.int64)[level[1:-1, 1:-1]]


def read_slice(data, width, height):
    """A slice of a rectangle of so many px: its first column and row, mask, heights in units."""
    mode, x, y, columns, rows = data[0] >> 4, data[1], data[2], data[3], data[4]
    step = data[5] | data[6] << 8
    if mode > 1 or not 9 <= step <= 4095 or columns < 1 or rows < 1:
        raise ValueError("not a slice")
    if x + columns > (width + 7) // 8 or y + rows > (height + 7) // 8:
        raise ValueError("a slice leaves its rectangle")
    coder = RangeDecoder(data[7:])
    mask = read_mask(coder, min(8 * columns, width - 8 * x), min(8 * rows, height - 8 * y))
    if mode == 0:
        heights = read_smooth(coder, mask, columns, rows, step, (data[0] & 15) + 1)
    else:
        heights = read_rough(coder, mask, step)
    return 8 * x, 8 * y, mask, np.where(mask != 0, np.clip(heights, -4096, 4096000), 0)


def check(path):
    mask = heights = None
    slices = 0
    with open(path, encoding="ascii") as lines:
        for line in lines:
            word, *rest = line.split()
            if word == "rect":
                mask = np.zeros((int(rest[1]), int(rest[0])), np.uint8)
                heights = np.zeros(mask.shape, "<i4")
            elif word == "slice":
                u, v, part, units = read_slice(bytes.fromhex("".join(rest)), mask.shape[1], mask.shape[0])
                mask[v:v + part.shape[0], u:u + part.shape[1]] = part
                heights[v:v + part.shape[0], u:u + part.shape[1]] = units
                slices += 1
            elif word == "crc":
                got = f"{zlib.crc32(mask.tobytes()):08x}", f"{zlib.crc32(heights.tobytes()):08x}"
                if list(got) != rest:
                    sys.exit(f"{path}: mask {got[0]} and heights {got[1]}, expected {rest[0]} and {rest[1]}")
    print(f"{path}: {slices} slices, {int(mask.sum())} px, as expected")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        check(name)
