"""Reads Gadget-2 files as other tools do, with nothing of fixpair, and checks that they are what they say.

    python3 check_gadget.py FOLDER    all files of 01_fixed_paired_png

Byte layout and header are those of the user guide of Gadget-2. What can be known without knowing the random field is checked:
lengths, masses, ids, the box, and that velocities belong to displacements, v = a H D' Psi with D' = dlnD/dlna near 1 at high redshift,
which fails if the factor sqrt(a) or the unit of length is wrong. Pairs must move oppositely, but for second order.
"""

import math
import os
import struct
import sys
from array import array

CRITICAL_DENSITY = 27.7536627  # 1e10 Msun/h over (Mpc/h)^3
HEADER = "6I6d2d2i6I2i4d2i6Ii60x"
FAILURES = []


def claim(holds, text):
    if not holds:
        FAILURES.append(text)
        print("  FAILS  ", text, sep="")


def records(path):
    """The records of a Fortran-like file, each between two copies of its length."""
    with open(path, "rb") as stream:
        data = stream.read()
    start = 0
    while start < len(data):
        (before,) = struct.unpack_from("<I", data, start)
        end = start + 4 + before
        (after,) = struct.unpack_from("<I", data, end)
        if before != after:
            raise ValueError(f"{path}: a record of {before} bytes ends with {after}")
        yield data[start + 4 : end]
        start = end + 4


def numbers(code, data):
    values = array(code)
    values.frombytes(data)
    if sys.byteorder == "big":
        values.byteswap()
    return values


class Snapshot:
    """Positions in Mpc/h, displacements from the lattice in Mpc/h, peculiar velocities in km/s, all in order of id."""

    def __init__(self, path):
        header, position, velocity, ids = records(path)
        self.name = os.path.basename(path)
        claim(len(header) == 256, f"{self.name}: the header has 256 bytes")
        fields = struct.unpack("<" + HEADER, header)
        self.count, total, others = fields[1], fields[17], fields[:1] + fields[2:6]
        self.mass, self.a, self.redshift = fields[7], fields[12], fields[13]
        self.files, self.box, self.omega_m, self.omega_de, self.h = fields[23:28]
        self.side, self.id_bytes = round(self.count ** (1 / 3)), len(ids) // self.count
        claim(self.side**3 == self.count == total and not any(others), f"{self.name}: a cube of particles, all of type 1")
        claim(self.files == 1, f"{self.name}: one file")
        claim(len(position) == len(velocity) == 12 * self.count, f"{self.name}: 12 bytes a particle for x and for v")
        claim(len(ids) in (4 * self.count, 8 * self.count), f"{self.name}: 4 or 8 bytes an id")
        claim(abs(self.a * (1 + self.redshift) - 1) < 1e-14, f"{self.name}: a = 1/(1 + z)")
        self.find_unit()
        self.read_particles(numbers("f", position), numbers("f", velocity), numbers("IQ"[self.id_bytes == 8], ids))

    def find_unit(self):
        """The mass of a particle tells in which unit the box is."""
        length = (self.mass * self.count / (CRITICAL_DENSITY * self.omega_m)) ** (1 / 3)
        unit = self.box / length
        self.unit = 1000.0 if unit > 30 else 1.0
        claim(abs(unit / self.unit - 1) < 1e-12, f"{self.name}: masses fill the box in kpc/h or Mpc/h")

    def read_particles(self, position, velocity, ids):
        side = self.side
        claim(min(position) >= 0 and max(position) < self.box, f"{self.name}: positions are in [0, BoxSize)")
        claim(sorted(ids) == list(range(1, self.count + 1)), f"{self.name}: ids are 1 to {self.count}")
        cell, half = self.box / side, self.box / 2
        self.displacement, self.velocity = array("d", bytes(24 * self.count)), array("d", bytes(24 * self.count))
        for row, number in enumerate(ids):
            cells = (number - 1) // side**2, (number - 1) // side % side, (number - 1) % side
            for axis in range(3):
                moved = (position[3 * row + axis] - cells[axis] * cell + half) % self.box - half
                self.displacement[3 * (number - 1) + axis] = moved / self.unit
                self.velocity[3 * (number - 1) + axis] = velocity[3 * row + axis] * math.sqrt(self.a)

    def expansion(self):
        curvature = 1 - self.omega_m - self.omega_de
        return math.sqrt(self.omega_m / self.a**3 + curvature / self.a**2 + self.omega_de)


def dot(first, second):
    return math.fsum(a * b for a, b in zip(first, second))


def check_motion(snapshot):
    square = dot(snapshot.displacement, snapshot.displacement)
    rate = dot(snapshot.displacement, snapshot.velocity) / square
    correlation = rate * math.sqrt(square / dot(snapshot.velocity, snapshot.velocity))
    rate /= snapshot.a * 100 * snapshot.expansion()
    # Second order moves twice as fast, and is some 0.3% of the displacements; dlnD/dlna is 0.99996 at z = 32.
    claim(abs(rate - 1) < 3e-3, f"{snapshot.name}: velocities are a H times the displacements, and not {rate} times that")
    claim(correlation > 0.9999, f"{snapshot.name}: velocities are parallel to the displacements, and not to {correlation}")
    print(
        f"  {snapshot.name:24}{snapshot.side}^3 in {snapshot.box / snapshot.unit:g} Mpc/h at z = {snapshot.redshift:g}, "
        f"lengths in {'kpc' if snapshot.unit > 1 else 'Mpc'}/h, {snapshot.id_bytes}-byte ids; "
        f"moved by {math.sqrt(square / snapshot.count):.4f} Mpc/h, v = {rate:.5f} a H Psi"
    )


def check_pair(name, original, inverted):
    even = [a + b for a, b in zip(original.displacement, inverted.displacement)]
    odd = [a - b for a, b in zip(original.displacement, inverted.displacement)]
    ratio = math.sqrt(dot(even, even) / dot(odd, odd))
    # To the second order's 0.3%, f_NL = 100 adds as much as 1%: f_NL Phi is 1e-3, and weighs most on the largest scales.
    claim(0 < ratio < 0.02, f"{name}: original and inverted move oppositely, and not to {ratio}")
    print(f"  {name}: original and inverted move oppositely, to {ratio:.1e}")


def main(folder):
    for amplitude in ("normal", "fixed"):
        for f_nl in ("fnl0", "fnl100"):
            pair = []
            for phase in ("original", "inverted"):
                pair.append(Snapshot(os.path.join(folder, f"{amplitude}_{phase}_{f_nl}")))
                check_motion(pair[-1])
            check_pair(f"{amplitude}_{f_nl}", *pair)
    print("  all of it holds" if not FAILURES else f"  {len(FAILURES)} claims fail")
    return 1 if FAILURES else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
