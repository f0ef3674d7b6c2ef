"""Seconds that Pylians3 takes for P(k) with l = 0, 2, 4 of an N^3 float32 mesh, one thread, transform included.

    python pylians_power.py N [REPEATS]

Prints `power_0_2_4 seconds`, the median of REPEATS (default 5). The same call also fills Pylians's 1D and (k_par, k_per)
spectra; it has no switch to leave them out.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import statistics
import sys
import time

import numpy as np
import Pk_library as PKL


def main():
    n = int(sys.argv[1])
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    delta = np.random.default_rng(1).standard_normal((n, n, n), np.float32)
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        PKL.Pk(delta, 1000.0, axis=2, MAS="CIC", threads=1, verbose=False)
        seconds.append(time.perf_counter() - start)
    print(f"power_0_2_4 {statistics.median(seconds):.4f}")


if __name__ == "__main__":
    main()
