"""Times friends of friends of other programs, one thread: name, seconds, groups (single particles included).

Called by benches/halos.rs with a file of float64 triples, the side of the box and the linking length.
"""

import sys
import time

import numpy as np


def kdcount(x, box_size, length):
    from kdcount import cluster, models

    data = models.points(x, boxsize=box_size)
    start = time.perf_counter()
    found = cluster.fof(data, length, np=0)
    return time.perf_counter() - start, int(found.N)


def main():
    x = np.fromfile(sys.argv[1]).reshape(-1, 3)
    box_size, length = float(sys.argv[2]), float(sys.argv[3])
    for program in (kdcount,):
        try:
            seconds, groups = program(x, box_size, length)
        except ImportError:
            continue
        print(program.__name__, seconds, groups, flush=True)


main()
