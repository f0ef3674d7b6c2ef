"""Shapes of primordial non-Gaussianity: the cases of Rust."""

import ctypes

import fixpair_ctypes as fixpair
from ctypes_check import FINE, N, Buffer, check, elements, integers, made
from fixpair_ctypes import Brick, ShapeRow

SHAPES = {"local": fixpair.LOCAL, "equilateral": fixpair.EQUILATERAL, "orthogonal": fixpair.ORTHOGONAL,
          "orthogonal_lss": fixpair.ORTHOGONAL_LSS, "folded": fixpair.FOLDED}
OWN = ((1.5, 0.5, -1.25, 0.75), (-2.0, 0.5, -1.0, 0.5), (0.25, 1.0, -0.5, -0.5))


def rows_of(library, shape):
    rows, count = Buffer(ShapeRow, 8), ctypes.c_size_t()
    library.shape_rows(rows.start, 8, count, shape)
    return rows, count.value


def shapes(twin):
    library, pieces = twin.library, []
    brick = made(Brick, library.brick_whole, N, fixpair.FOURIER, 0)
    gaussian = twin.white(brick, twin.realisation(), twin.universe.amplitude)

    def add(name, rows, count, side):
        phi, work = Buffer(twin.real, len(gaussian.array)), twin.transform(side)
        ctypes.memmove(phi.start, gaussian.start, gaussian.size)
        layout = twin.layout("add_shape_scratch", brick, work)
        scratch = Buffer(ctypes.c_uint8, layout.size)
        twin.call("add_shape", phi.start, len(phi.array), brick, 5000.0, 0.96, rows.start, count, work, scratch.start,
                  scratch.size, twin.run)
        twin.case(f"add_shape.{name}", integers(layout.size, layout.align), elements(phi, brick))

    for name, shape in SHAPES.items():
        rows, count = rows_of(library, shape)
        pieces.append(bytes(rows)[:count * ctypes.sizeof(ShapeRow)])
        add(name, rows, count, FINE)
    twin.universe.case("shape_rows", *pieces)
    own = Buffer(ShapeRow, len(OWN))
    own.array[:] = [ShapeRow(*row) for row in OWN]
    add("own", own, len(OWN), N)
    try:
        library.shape_rows(None, 0, ctypes.c_size_t(), fixpair.ORTHOGONAL_LSS + 9)
        check(False, "an unknown shape is refused")
    except fixpair.Refused as refused:
        check(refused.status == -14, "an unknown shape is refused as a choice")
