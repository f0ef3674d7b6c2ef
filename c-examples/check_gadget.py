"""Reads Gadget-2 files as other tools do, with nothing of fixpair, and checks that they are what they say.

    python3 check_gadget.py FOLDER                      all files of 01_fixed_paired_png
    python3 check_gadget.py --snapshots PATH...         particles that started from a lattice; PATH.0, PATH.1 ... if there is no PATH
    python3 check_gadget.py --glass GLASS TILES PATH... particles that started from a glass, tiled TILES^3
    python3 check_gadget.py --pair PATH PATH            of one seed and opposite phases

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


def read_glass(path):
    """Coordinates of the particles of a tile, in units of its side."""
    header, position, *_ = records(path)
    box = struct.unpack("<" + HEADER, header)[24]
    return [x / box for x in numbers("f", position)]


def files(path):
    if os.path.exists(path):
        return [path]
    names = []
    while os.path.exists(f"{path}.{len(names)}"):
        names.append(f"{path}.{len(names)}")
    return names


class Snapshot:
    """Positions in Mpc/h, displacements in Mpc/h from where particles stood, peculiar velocities in km/s, all in order of id.

    Particles stood at the corners of a lattice, or in `tiles`^3 copies of `tile`. Masses may be off by `mass_error`: G has
    more than one value in use.
    """

    def __init__(self, path, tile=None, tiles=0, mass_error=1e-12):
        self.name = os.path.basename(path)
        position, velocity, ids = array("f"), array("f"), array("Q")
        names = files(path)
        for name in names:
            self.add_file(name, len(names), position, velocity, ids)
        self.count = len(ids)
        self.side = round(self.count ** (1 / 3))
        self.tile, self.tiles = tile or [0.0, 0.0, 0.0], tiles or self.side
        claim(self.total == self.count == self.tiles**3 * len(self.tile) // 3, f"{self.name}: all particles are there")
        self.find_unit(mass_error)
        self.read_particles(position, velocity, ids)

    def add_file(self, path, files, position, velocity, ids):
        header, x, v, numbered = records(path)
        claim(len(header) == 256, f"{self.name}: the header has 256 bytes")
        fields = struct.unpack("<" + HEADER, header)
        count, others = fields[1], fields[:1] + fields[2:6]
        self.total, self.mass, self.a, self.redshift = fields[17], fields[7], fields[12], fields[13]
        self.box, self.omega_m, self.omega_de, self.h = fields[24:28]
        self.id_bytes = len(numbered) // count
        claim(not any(others), f"{self.name}: all of type 1")
        claim(fields[23] == files, f"{self.name}: {files} files, and the header says so")
        claim(len(x) == len(v) == 12 * count, f"{self.name}: 12 bytes a particle for x and for v")
        claim(len(numbered) in (4 * count, 8 * count), f"{self.name}: 4 or 8 bytes an id")
        claim(abs(self.a * (1 + self.redshift) - 1) < 1e-14, f"{self.name}: a = 1/(1 + z)")
        position.extend(numbers("f", x))
        velocity.extend(numbers("f", v))
        ids.extend(list(numbers("IQ"[self.id_bytes == 8], numbered)))

    def find_unit(self, mass_error):
        """The mass of a particle tells in which unit the box is."""
        length = (self.mass * self.count / (CRITICAL_DENSITY * self.omega_m)) ** (1 / 3)
        unit = self.box / length
        self.unit = 1000.0 if unit > 30 else 1.0
        claim(abs(unit / self.unit - 1) < mass_error, f"{self.name}: masses fill the box in kpc/h or Mpc/h")

    def stood(self, number, axis):
        """Where the particle with this id, counted from 0, was before it was displaced."""
        each, tiles = len(self.tile) // 3, self.tiles
        cell = number // each // tiles ** (2 - axis) % tiles
        return (cell + self.tile[3 * (number % each) + axis]) * (self.box / tiles)

    def read_particles(self, position, velocity, ids):
        claim(min(position) >= 0 and max(position) < self.box, f"{self.name}: positions are in [0, BoxSize)")
        claim(sorted(ids) == list(range(1, self.count + 1)), f"{self.name}: ids are 1 to {self.count}")
        half = self.box / 2
        self.displacement, self.velocity = array("d", bytes(24 * self.count)), array("d", bytes(24 * self.count))
        for row, number in enumerate(ids):
            for axis in range(3):
                moved = (position[3 * row + axis] - self.stood(number - 1, axis) + half) % self.box - half
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
        f"  {snapshot.name:24}{snapshot.count} in {snapshot.box / snapshot.unit:g} Mpc/h at z = {snapshot.redshift:g}, "
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


def check_folder(folder):
    for amplitude in ("normal", "fixed"):
        for f_nl in ("fnl0", "fnl100"):
            pair = []
            for phase in ("original", "inverted"):
                pair.append(Snapshot(os.path.join(folder, f"{amplitude}_{phase}_{f_nl}")))
                check_motion(pair[-1])
            check_pair(f"{amplitude}_{f_nl}", *pair)


def check_snapshots(paths, tile=None, tiles=0):
    for path in paths:
        check_motion(Snapshot(path, tile, tiles, 1e-3))


def main(arguments):
    if arguments[0] == "--snapshots" and len(arguments) > 1:
        check_snapshots(arguments[1:])
    elif arguments[0] == "--glass" and len(arguments) > 3:
        check_snapshots(arguments[3:], read_glass(arguments[1]), int(arguments[2]))
    elif arguments[0] == "--pair" and len(arguments) == 3:
        check_pair(os.path.basename(arguments[1]), *(Snapshot(path, mass_error=1e-3) for path in arguments[1:]))
    elif len(arguments) == 1:
        check_folder(arguments[0])
    else:
        sys.exit(__doc__)
    print("  all of it holds" if not FAILURES else f"  {len(FAILURES)} claims fail")
    return 1 if FAILURES else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
