"""Runs `tetwarp simulate --film --picture`, decodes GIF and PNG and compares their pictures.

Usage: check_film.py COMMAND

Exits 77 when the command was built without giflib, 1 when the pictures differ.
"""
import os
import struct
import subprocess
import sys
import tempfile
import zlib


def read_png(path):
    """Width, height and RGB bytes of an 8-bit RGB PNG."""
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (depth, color) == (8, 2), path
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytes(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = row[x - 3] if x >= 3 else 0
            corner = above[x - 3] if x >= 3 else 0
            guess = left + above[x] - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - above[x]), 1, above[x]),
                        (abs(guess - corner), 2, corner))[2]
            row[x] = (row[x] + (0, left, above[x], (left + above[x]) // 2, paeth)[kind]) & 255
        above = bytes(row)
        rows.append(above)
    return width, height, b"".join(rows)


def unpack_lzw(data, bits):
    clear, end = 1 << bits, (1 << bits) + 1
    out, width, table, last = bytearray(), bits + 1, {}, b""
    number, count = 0, 0
    for byte in data:
        number, count = number | byte << count, count + 8
        while count >= width:
            code, number, count = number & ((1 << width) - 1), number >> width, count - width
            if code == clear:
                table, width, last = {c: bytes([c]) for c in range(clear)}, bits + 1, b""
                continue
            if code == end:
                return bytes(out)
            entry = table[code] if code in table else last + last[:1]
            out += entry
            if last:
                table[len(table) + 2] = last + entry[:1]
            if len(table) + 2 == 1 << width and width < 12:
                width += 1
            last = entry
    raise AssertionError("no end of the picture")


def read_gif(path):
    """Width, height and the list of (RGB bytes, delay in 1/100 s)."""
    data = open(path, "rb").read()
    assert data[:6] == b"GIF89a"
    width, height, flags = struct.unpack("<HHB", data[6:11])
    at, delay, frames = 13, 0, []
    assert not flags & 128, "a palette for all pictures"
    screen = bytearray(3 * width * height)

    def blocks(at):
        content = b""
        while data[at]:
            content += data[at + 1:at + 1 + data[at]]
            at += 1 + data[at]
        return content, at + 1

    while data[at] != 0x3B:
        if data[at] == 0x21:
            content, end = blocks(at + 2)
            if data[at + 1] == 0xF9:
                delay = struct.unpack("<H", content[1:3])[0]
            at = end
            continue
        assert data[at] == 0x2C
        left, top, columns, rows, flags = struct.unpack("<HHHHB", data[at + 1:at + 10])
        assert flags & 128 and not flags & 64
        size = 2 << (flags & 7)
        palette = data[at + 10:at + 10 + 3 * size]
        bits = data[at + 10 + 3 * size]
        content, at = blocks(at + 11 + 3 * size)
        indices = unpack_lzw(content, bits)
        assert len(indices) == columns * rows
        for n, index in enumerate(indices):
            to = 3 * ((top + n // columns) * width + left + n % columns)
            screen[to:to + 3] = palette[3 * index:3 * index + 3]
        frames.append((bytes(screen), delay))
    return width, height, frames


def main():
    command = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [command, "simulate", "--scene", "chain", "-o", "out", "--steps", "41", "--picture",
             "--film", "film.gif", "--pixels", "120,80"],
            cwd=folder, capture_output=True, text=True, check=False)
        if "libgif-dev" in done.stderr:
            print(f"skipped: {done.stderr.strip()}")
            return 77
        assert done.returncode == 0, done.stderr
        width, height, frames = read_gif(os.path.join(folder, "film.gif"))
        pictures = sorted(name for name in os.listdir(os.path.join(folder, "out"))
                          if name.endswith(".png"))
        assert len(frames) == len(pictures) > 5, (len(frames), len(pictures))
        largest = 0
        for (rgb, _), name in zip(frames, pictures):
            size = read_png(os.path.join(folder, "out", name))
            assert size[:2] == (width, height)
            largest = max(largest, max(abs(a - b) for a, b in zip(rgb, size[2])))
        assert largest <= 8, f"a color of the film is off by {largest} of 255"
        shown = sum(delay for _, delay in frames) - frames[-1][1]
        assert abs(shown - 100 * 41 * 0.005) <= 2, f"{shown} hundredths of a second"
        print(f"{len(frames)} pictures, colors within {largest} of 255")
    return 0


if __name__ == "__main__":
    sys.exit(main())
