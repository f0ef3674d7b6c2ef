"""Fields and particles to test with."""

import numpy as np

BOX = 200.0
SEED = 20220411


def numbers(count, start=0):
    """Numbers in [-1, 1), the same on every machine."""
    i = np.arange(start, start + count, dtype=np.uint64)
    return ((i * np.uint64(2654435761) + np.uint64(12345)) & np.uint64(0xFFFFFFFF)) / 2147483648.0 - 1.0


def scattered(count, dtype, box=BOX, start=0):
    """Positions all over the box."""
    return ((numbers(3 * count, start).reshape(count, 3) + 1.0) * (box / 2)).astype(dtype)


def address(array):
    return array.__array_interface__["data"][0]


def tolerance(dtype, factor):
    """So many roundings of numbers of order 1."""
    return factor * float(np.finfo(dtype).eps)
