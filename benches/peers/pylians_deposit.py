"""Seconds that Pylians3 takes to deposit N^3 float32 particles on an N^3 float32 mesh, one thread.

    python pylians_deposit.py N [REPEATS]

Prints a line `name seconds` for each window and order, the median of REPEATS (default 3). Zeroing the mesh is
not timed: Pylians adds to the array it is given.

`lattice`: particle (i, j, k) of a lattice, in C order, each coordinate moved by a sine of 3 cells amplitude, one wave in
the box, that depends on another coordinate: neighbours in memory stay neighbours on the mesh.
`random`: uniform positions: neighbours in memory are strangers on the mesh.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import statistics
import sys
import time

import MAS_library as MASL
import numpy as np

BOX = 1000.0  # Mpc/h; only position / cell enters the work
AMPLITUDE = 3.0  # cells


def lattice(n):
    """(n^3, 3) float32 positions: cell centres plus a smooth displacement, wrapped into [0, BOX)."""
    cell = BOX / n
    centre = (np.arange(n) + 0.5) * cell
    wave = AMPLITUDE * cell * np.sin(2.0 * np.pi * centre / BOX)
    position = np.empty((n, n, n, 3), np.float32)
    position[..., 0] = np.mod(centre[:, None, None] + wave[None, :, None], BOX)
    position[..., 1] = np.mod(centre[None, :, None] + wave[None, None, :], BOX)
    position[..., 2] = np.mod(centre[None, None, :] + wave[:, None, None], BOX)
    return inside(position.reshape(-1, 3))


def uniform(n):
    """(n^3, 3) float32 positions, uniform in [0, BOX)."""
    return inside(np.random.default_rng(1).random((n**3, 3), np.float32) * np.float32(BOX))


def inside(position):
    """Rounding to float32 may land on BOX itself, which is position 0."""
    position[position >= BOX] = 0.0
    return position


def main():
    n = int(sys.argv[1])
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    mesh = np.zeros((n, n, n), np.float32)
    for order, position in ("lattice", lattice(n)), ("random", uniform(n)):
        for window in "NGP", "CIC", "TSC", "PCS":
            seconds = []
            for _ in range(repeats):
                mesh[:] = 0.0
                start = time.perf_counter()
                MASL.MA(position, mesh, BOX, window, verbose=False)
                seconds.append(time.perf_counter() - start)
            mass = mesh.sum(dtype=np.float64)
            # Each cell is rounded to 24 bits some tens of times: far below 1e-5 of the total.
            assert abs(mass / n**3 - 1.0) < 1e-5, f"{window} {order}: deposited {mass} of {n**3}"
            print(f"{window.lower()}_{order} {statistics.median(seconds):.4f}", flush=True)


if __name__ == "__main__":
    main()
