"""Draws the icon of the desktop entry for Windows: icon.py palpate.svg palpate.ico

Knows what that file consists of: a rounded square, circles, and a line with round ends.
"""

from __future__ import annotations

import re
import struct
import sys
import xml.etree.ElementTree
import zlib

import numpy as np

SIDE = 128.0  # of the drawing
SIZES = (16, 24, 32, 48, 64, 256)


def shapes(file: str):
    """Signed distance from the edge (function of x and y), colour and opacity of each shape, back to front."""
    def visit(element, colour):
        kind = element.tag.rpartition("}")[2]
        a = element.attrib
        colour = a.get("fill", colour)
        if kind == "rect":
            half, corner = float(a["width"]) / 2, float(a["rx"])
            def square(x, y):
                inner = np.stack([np.abs(x - half), np.abs(y - half)]) - (half - corner)
                return np.hypot(*np.maximum(inner, 0)) + np.minimum(inner.max(0), 0) - corner
            yield square, colour, 1.0
        elif kind == "circle":
            cx, cy, r = (float(a[key]) for key in ("cx", "cy", "r"))
            yield (lambda x, y: np.hypot(x - cx, y - cy) - r), colour, float(a.get("opacity", 1))
        elif kind == "path":
            ax, ay, bx, by = (float(number) for number in re.findall(r"[\d.]+", a["d"]))
            def line(x, y):
                along = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2), 0, 1)
                return np.hypot(x - ax - along * (bx - ax), y - ay - along * (by - ay)) - float(a["stroke-width"]) / 2
            yield line, a["stroke"], 1.0
        elif kind not in ("svg", "g", "title"):
            sys.exit(f"icon.py: {file}: cannot draw <{kind}>")
        for child in element:
            yield from visit(child, colour)

    yield from visit(xml.etree.ElementTree.parse(file).getroot(), "#000000")


def picture(file: str, pixels: int) -> np.ndarray:
    """Rows of RGBA, 8 bits."""
    centres = (np.arange(pixels) + 0.5) * SIDE / pixels
    x, y = np.meshgrid(centres, centres)
    image = np.zeros((pixels, pixels, 4))  # premultiplied
    for distance, colour, opacity in shapes(file):
        cover = opacity * np.clip(0.5 - distance(x, y) * pixels / SIDE, 0, 1)[..., None]
        rgb = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
        image = cover * np.array([*rgb, 1]) + (1 - cover) * image
    image[..., :3] /= np.maximum(image[..., 3:], 1e-9)
    return np.rint(255 * image).astype(np.uint8)


def png(image: np.ndarray) -> bytes:
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(b"\0" + row.tobytes() for row in image)
    header = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def main() -> None:
    pictures = [png(picture(sys.argv[1], pixels)) for pixels in SIZES]
    entries, at = b"", 6 + 16 * len(SIZES)
    for pixels, data in zip(SIZES, pictures):
        entries += struct.pack("<BBBBHHII", pixels % 256, pixels % 256, 0, 0, 1, 32, len(data), at)
        at += len(data)
    with open(sys.argv[2], "wb") as out:
        out.write(struct.pack("<HHH", 0, 1, len(SIZES)) + entries + b"".join(pictures))


if __name__ == "__main__":
    main()
