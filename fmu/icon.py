"""model.png of an FMU: a warm-up curve, drawn point by point so that it needs no image file."""

from __future__ import annotations

import struct
import zlib

import numpy as np

_SIZE = 96
_PAPER, _AXIS, _CURVE = (255, 255, 255), (90, 90, 90), (208, 74, 32)


def icon() -> bytes:
    """The picture as PNG."""
    across, down = np.meshgrid(np.arange(_SIZE) + 0.5, np.arange(_SIZE) + 0.5)
    x, y = (across - 14) / 70, (_SIZE - 14 - down) / 70  # the unit square of the plot
    rise = 0.9 * (1 - np.exp(-3.5 * x))
    steepness = np.hypot(1, 0.9 * 3.5 * np.exp(-3.5 * x))
    picture = np.full((_SIZE, _SIZE, 3), _PAPER, dtype=np.uint8)
    on_axis = ((np.abs(x) < 0.02) & (y > -0.02) & (y < 1.05)) | ((np.abs(y) < 0.02) & (x > -0.02) & (x < 1.05))
    picture[on_axis] = _AXIS
    picture[(x > 0.02) & (x < 1.02) & (np.abs(y - rise) < 0.035 * steepness)] = _CURVE
    return _png(picture)


def _png(picture: np.ndarray) -> bytes:
    height, width, _ = picture.shape
    rows = b"".join(b"\0" + row.tobytes() for row in picture)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    body = b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body
