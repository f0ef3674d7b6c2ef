"""Are two files of positions, doubles as mpi_ic --output writes them, the same to the rounding of transforms?"""

import array
import sys


def read(name):
    values = array.array("d")
    with open(name, "rb") as file:
        values.frombytes(file.read())
    return values


one, other = map(read, sys.argv[1:3])
size = max(one)
# A particle at the edge of the box may be on either side of it.
apart = max(min(abs(a - b), size - abs(a - b)) for a, b in zip(one, other)) if len(one) == len(other) > 0 else size
print(f"{len(one) // 3} and {len(other) // 3} particles, at most {apart / size:.1e} of the box apart")
sys.exit(not apart < 1e-13 * size)
