"""Icon of an FMU: a wheel and a warm pinion that mesh, drawn point by point so that it needs no image file."""

from __future__ import annotations

import struct
import zlib

import numpy as np

#: Length of an edge [pixel]; importers draw icons at about this size.
_SIZE = 96
#: Points drawn along each pixel; their mean smooths the edges.
_FINE = 4
#: Colour of the ground, red, green and blue of 255: white.
_PAPER = (255, 255, 255)
#: Colour of the wheel: steel blue, the cold one.
_WHEEL = (74, 98, 122)
#: Colour of the pinion: red, the warm one.
_PINION = (208, 74, 32)


def icon() -> bytes:
    """The picture as PNG."""
    across, down = np.meshgrid(*[(np.arange(_FINE * _SIZE) + 0.5) / _FINE] * 2)
    picture = np.full((*across.shape, 3), _PAPER, dtype=float)
    picture[_gear(across - 36, down - 58, 27.0, 14)] = _WHEEL
    picture[_gear(across - 68.5, down - 29.5, 15.5, 8)] = _PINION
    smooth = picture.reshape(_SIZE, _FINE, _SIZE, _FINE, 3).mean(axis=(1, 3))
    return _png(smooth.round().astype(np.uint8))


def _gear(x: np.ndarray, y: np.ndarray, r: float, teeth: int) -> np.ndarray:
    """Whether points are inside a gear around the origin: its teeth, a disc, a bore.

    Args:
        x, y: of the points [pixel]
        r: pitch radius [pixel]
        teeth: their number
    """
    tooth = np.clip(1.6 * np.cos(teeth * np.arctan2(y, x)), -1, 1)
    radius = np.hypot(x, y)
    return np.asarray((radius < r + 3.4 * tooth) & (radius > 0.32 * r))


def _png(picture: np.ndarray) -> bytes:
    height, width, _ = picture.shape
    rows = b"".join(b"\0" + row.tobytes() for row in picture)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    body = b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body
