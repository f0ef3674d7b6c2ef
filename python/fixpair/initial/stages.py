"""Initial conditions stage by stage: from modes of the potential to density, displacements and particles."""

from typing import NamedTuple

import numpy as np

from .. import native
from .._arrays import Particles, alike, same, triples, vector, view
from .._library import twin
from ..fft import Transform
from ..mesh import Brick
from ..native import Space
from ..threads import current
from ..workspace import scratch


def scale_modes(modes: np.ndarray, table: np.ndarray, *, brick: native.Structure | None = None) -> np.ndarray:
    """f_k <- f_k table[|n|^2], n = k L/(2 pi), in place; Nyquist modes become zero. With a table of alpha: from Phi to the density."""
    where, table = view(modes, brick, Space.FOURIER, "modes", write=True), vector(table, "table")
    twin("scale_modes", where.real)(where.start, where.length, where.brick, table, table.size, current())
    return modes


def copy_modes(to: np.ndarray, source: np.ndarray, *, to_brick: native.Structure | None = None,
               source_brick: native.Structure | None = None) -> np.ndarray:
    """Copies modes to a mesh of another side or layout. Those that one mesh has alone are dropped or become zero."""
    where = view(to, to_brick, Space.FOURIER, "to", write=True)
    start = view(source, source_brick, Space.FOURIER, "source")
    same(where.real, start.real, "source")
    twin("copy_modes", where.real)(where.start, where.length, where.brick, start.start, start.length, start.brick, current())
    return to


def second_order_source(density: np.ndarray, work: Transform, *, out: np.ndarray | None = None,
                        brick: native.Structure | None = None) -> np.ndarray:
    """S = sum over a < b of phi_aa phi_bb - phi_ab^2, phi_ab of modes k_a k_b/k^2 delta_k: the source of second-order displacements.

    density: modes of the linear density, complex numbers (n, n, n/2 + 1), or memory of the brick. work: a transform of side n (products
    alias), or of 3n/2 or more (exact). out: laid out as density; new if None. Returns modes of S.
    """
    start = view(density, brick, Space.FOURIER, "density")
    same(work.real, start.real, "density")
    if out is None:
        out = Brick.from_buffer_copy(start.brick).zeros(work.dtype)
    where = view(out, start.brick, Space.FOURIER, "out", write=True)
    alike((start, where), ("density", "out"))
    meshes = [work.mesh() for _ in range(3)]
    with work.use() as hook:
        twin("second_order_source", work.real)(where.start, where.length, start.start, start.length, where.brick, hook, *meshes,
                                               work.length, current())
    return out


class ThirdOrderSources(NamedTuple):
    """Modes, complex numbers (n, n, n/2 + 1): S, A = det p, B = p_aa q_bb - p_ab q_ab, and the components of C_i = eps_ijk p_lj q_lk."""

    second: np.ndarray
    determinant: np.ndarray
    mixed: np.ndarray
    curl_x: np.ndarray
    curl_y: np.ndarray
    curl_z: np.ndarray


def third_order_sources(density: np.ndarray, fft: Transform) -> ThirdOrderSources:
    """The sources of the second and third orders, without aliasing, from data of a transform that holds modes of the density.

    Displacements are Psi2_k = -(D2/D^2) i k/k^2 S, Psi3a_k = (D3a/D^3) i k/k^2 A, Psi3b_k = (D3b/D^3) i k/k^2 B by
    :func:`displacement`, and Psi3c_k = (D3c/D^3) i k x C/k^2 by :func:`transverse_displacement`.
    """
    fft.check(density, "density")
    outputs = [fft.mesh() for _ in range(6)]
    with fft.use() as hook, scratch(twin("third_order_sources_scratch", fft.real), hook) as (memory, size):
        twin("third_order_sources", fft.real)(*outputs, density, fft.length, hook, memory, size, current())
    return ThirdOrderSources(*map(fft.modes, outputs))


def displacement(source: np.ndarray, axis: int, scale: float, fft: Transform, *, out: np.ndarray | None = None,
                 brick: native.Structure | None = None) -> np.ndarray:
    """One component of a displacement on the cells: modes scale i n_a/|n|^2 source_k, n = k L/(2 pi).

    The linear density with scale L/(2 pi) gives Psi1; S with -(D2/D^2) L/(2 pi) gives Psi2; in the unit of L. source: complex numbers
    (n, n, n/2 + 1), or memory of the brick. out: data of ``fft``; new if None. Returns ``fft.cells`` of it.
    """
    start = view(source, brick, Space.FOURIER, "source")
    same(fft.real, start.real, "source")
    psi = fft.mesh() if out is None else fft.check(out, "out", write=True)
    with fft.use() as hook:
        twin("displacement", fft.real)(psi, psi.size, start.start, start.length, start.brick, axis, scale, hook, current())
    return fft.cells(psi)


def transverse_displacement(sources: ThirdOrderSources, axis: int, scale: float, fft: Transform, *,
                            out: np.ndarray | None = None) -> np.ndarray:
    """One component of the transverse displacement of the third order: modes scale i (n x C)_axis/|n|^2, on the cells.

    scale: (D3c/D^3) L/(2 pi). sources: of :func:`third_order_sources` of the same transform. Returns ``fft.cells`` of `out`.
    """
    psi = fft.mesh() if out is None else fft.check(out, "out", write=True)
    curls = [view(curl, None, Space.FOURIER, "curl") for curl in sources[3:]]
    length = alike((view(fft.modes(psi), None, Space.FOURIER, "fft"), *curls), ("fft", "curl_x", "curl_y", "curl_z"))
    with fft.use() as hook:
        twin("transverse_displacement", fft.real)(psi, psi.size, *(curl.start for curl in curls), length, axis, scale,
                                                  hook, current())
    return fft.cells(psi)


def displace(position: Particles, velocity: Particles, psi1: np.ndarray, psi2: np.ndarray | None, axis: int,
             box_size: float, c1: float, c2: float = 0.0, *, brick: native.Structure | None = None) -> None:
    """Moves the particles of cells along one axis: x = q + psi1 + psi2, wrapped into [0, L); v = c1 psi1 + c2 psi2.

    position, velocity: one particle a cell, of which one component is written. psi1, psi2: real numbers (n, n, n), or memory of the
    brick; psi2 None at first order. c1, c2: velocity over displacement, a H f1 and a H f2, H = 100 E(a) km/s per Mpc/h.
    """
    first = view(psi1, brick, Space.CONFIGURATION, "psi1")
    second = None if psi2 is None else view(psi2, brick, Space.CONFIGURATION, "psi2")
    length = first.length if second is None else alike((first, second), ("psi1", "psi2"))
    where, speed = triples(position, "position", write=True), triples(velocity, "velocity", write=True)
    same(first.real, where.real, "position")
    same(first.real, speed.real, "velocity")
    twin("displace", first.real)(where.structure, speed.structure, first.start, second and second.start, length,
                                 first.brick, axis, box_size, c1, c2, current())
