"""Error maps as SVG, with PNG images and one colour ramp.

The ramp has equal steps of lightness in OKLab (Ottosson 2020), where equal distances look alike. The images
are opaque, so they are legible on white and on black.
"""

import base64
import struct
import zlib

import numpy as np
from svg import document, line, text

LEVELS = 64
# Lightness, chroma, and hue in degrees of the least and of the greatest error.
LEAST, GREATEST = (0.22, 0.10, 285.0), (0.93, 0.14, 100.0)
SIDE, GAP, LEFT, TOP, BAR = 150, 16, 130, 56, 14


def ramp():
    """The colours from the least to the greatest error, as bytes of red, green and blue."""
    share = np.linspace(0, 1, LEVELS)[:, None]
    lightness, chroma, hue = (np.array(LEAST) + share * (np.array(GREATEST) - LEAST)).T
    # Dark colours allow only a low chroma.
    a, b = chroma * np.cos(np.radians(hue)), chroma * np.sin(np.radians(hue))
    cone = np.array([[1, 0.3963377774, 0.2158037573], [1, -0.1055613458, -0.0638541728], [1, -0.0894841775, -1.2914855480]])
    light = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    linear = np.clip((light @ (cone @ [lightness, a, b]) ** 3).T, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)


def png(levels):
    """A PNG image with a palette; the first row is the top row."""
    height, width = levels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in levels.astype(np.uint8))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    parts = [(b"IHDR", head), (b"PLTE", ramp().tobytes()), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)


def image(levels, x, y, width, height):
    data = base64.b64encode(png(levels)).decode()
    place = f'x="{x:.1f}" y="{y:.1f}" width="{width}" height="{height}" preserveAspectRatio="none"'
    return f'<image {place} style="image-rendering: pixelated" href="data:image/png;base64,{data}"/>'


def draw(alt, columns, rows, powers):
    """A map of error magnitudes for each column of each row, on a logarithmic scale. `powers` are its first
    and last powers of ten.

    Rows are pairs of a name and a list of maps. A map is a pair of an array, whose first row is the lowest,
    and a line of text.
    """
    parts = [text(LEFT + i * (SIDE + GAP), TOP - 14, name, css="title") for i, name in enumerate(columns)]
    for j, (name, maps) in enumerate(rows):
        y = TOP + j * (SIDE + 40)
        parts.append(text(GAP, y + SIDE / 2, name))
        for i, (errors, words) in enumerate(maps):
            x = LEFT + i * (SIDE + GAP)
            parts += [image(levels_of(errors, powers)[::-1], x, y, SIDE, SIDE), text(x, y + SIDE + 18, words)]
    bottom = TOP + len(rows) * (SIDE + 40) + 8
    parts += scale(LEFT, bottom, 2 * SIDE, powers)
    return document(LEFT + len(columns) * (SIDE + GAP), bottom + 56, alt, parts)


def levels_of(errors, powers):
    first, last = powers
    share = (np.log10(np.maximum(np.abs(errors), 10.0**first)) - first) / (last - first)
    return np.clip(np.round(share * (LEVELS - 1)), 0, LEVELS - 1)


def scale(x, y, width, powers):
    first, last = powers
    yield image(np.arange(LEVELS)[None, :], x, y, width, BAR)
    for power in range(first, last + 1):
        at = x + width * (power - first) / (last - first)
        yield line(at, y + BAR, at, y + BAR + 5, "axis")
        yield text(at, y + BAR + 20, f"1e{power}", anchor="middle")
    yield text(x + width + 24, y + BAR - 2, "magnitude of the error")
