"""Seconds that Pylians3 takes for a few triangles of B(k1, k2, k3) of an N^3 float32 mesh, one thread, transforms included.

    python pylians_bispectrum.py N [TRIANGLES] [REPEATS]

Prints `bispectrum_T_triangles seconds` for T = 1 and T = TRIANGLES (default 4), the median of REPEATS (default 3), and from
the two `bispectrum_each_further_triangle seconds`. One call holds k1 = 9 k_f and k2 = 12 k_f and takes T angles between
them; a call with other k1, k2 starts again.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import contextlib
import io
import statistics
import sys
import time

import numpy as np
import Pk_library as PKL

BOX = 1000.0


def median_seconds(delta, triangles, repeats):
    fundamental = 2.0 * np.pi / BOX
    theta = np.linspace(0.25, 0.75, triangles) * np.pi
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        with contextlib.redirect_stdout(io.StringIO()):
            PKL.Bk(delta, BOX, 9.0 * fundamental, 12.0 * fundamental, theta, "CIC", 1)
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


def main():
    n = int(sys.argv[1])
    triangles = int(sys.argv[2]) if len(sys.argv) > 2 else 4
    repeats = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    if triangles < 2:
        sys.exit("TRIANGLES must be at least 2: the cost of a further triangle is a difference")
    delta = np.random.default_rng(1).standard_normal((n, n, n), np.float32)
    one = median_seconds(delta, 1, repeats)
    many = median_seconds(delta, triangles, repeats)
    print(f"bispectrum_1_triangles {one:.4f}")
    print(f"bispectrum_{triangles}_triangles {many:.4f}")
    print(f"bispectrum_each_further_triangle {(many - one) / (triangles - 1):.4f}")


if __name__ == "__main__":
    main()
