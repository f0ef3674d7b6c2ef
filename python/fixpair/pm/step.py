"""Kick, drift, and steps in time."""

from collections.abc import Sequence

import numpy as np

from .. import native
from .._arrays import Particles, alike, optional_triples, same, triples, view
from .._library import library, twin
from ..native import COLA_EXPONENT, Space, Stepper, Window
from ..threads import current
from ..workspace import scratch


def kick(velocity: Particles, position: Particles, force: Sequence[np.ndarray], box_size: float, *, keep: float = 1.0,
         factor: float = 1.0, first: float = 0.0, second: float = 0.0, psi1: Particles | None = None,
         psi2: Particles | None = None, window: int = Window.CIC, shift: float = 0.0,
         brick: native.Structure | None = None) -> None:
    """u_i <- keep u_i + factor F(x_i) + first psi1_i + second psi2_i, in place, F read out of three meshes as read_out does.

    Peculiar velocities go from a0 to a1 with f = :func:`kick_factors` and H0 (100 for km/s and Mpc/h): keep = a0/a1, factor = f.factor H0/a1,
    and for COLA first = f.first H0/(a1 D), second = f.second H0/(a1 D2). force: three meshes of real numbers (n, n, n).
    """
    speed, places = triples(velocity, "velocity", write=True), triples(position, "position")
    same(speed.real, places.real, "position")
    names = ("force_x", "force_y", "force_z")
    meshes = [view(mesh, brick, Space.CONFIGURATION, name) for mesh, name in zip(force, names, strict=True)]
    same(speed.real, meshes[0].real, "force")
    length = alike(meshes, names)
    displacements = [optional_triples(psi, name, speed) for psi, name in ((psi1, "psi1"), (psi2, "psi2"))]
    with scratch(twin("kick_scratch", speed.real), meshes[0].brick, places.particles, window) as (memory, size):
        twin("kick", speed.real)(speed.structure, places.structure, *(mesh.start for mesh in meshes), length, meshes[0].brick, box_size,
                                 window, shift, keep, factor, first, second, *displacements, memory, size, current())


def drift(position: Particles, velocity: Particles, box_size: float, *, factor: float = 1.0, first: float = 0.0,
          second: float = 0.0, psi1: Particles | None = None, psi2: Particles | None = None) -> None:
    """x_i <- x_i + factor u_i + first psi1_i + second psi2_i, in place, wrapped into [0, L).

    With f = :func:`drift_factors` and peculiar velocities of the time `at`: factor = f.factor at/H0, and for COLA first = f.first/D, second =
    f.second/D2.
    """
    places, speed = triples(position, "position", write=True), triples(velocity, "velocity")
    same(places.real, speed.real, "velocity")
    displacements = [optional_triples(psi, name, places) for psi, name in ((psi1, "psi1"), (psi2, "psi2"))]
    twin("drift", places.real)(places.structure, speed.structure, box_size, factor, first, second, *displacements, current())


def drift_factors(cosmology: native.Structure, start: float, end: float, at: float, *, stepper: int = Stepper.FASTPM,
                  cola_exponent: float = COLA_EXPONENT) -> native.Structure:
    """x += factor v + first psi1 + second psi2 from a scale factor to another, v = a u/H0 known at the time `at`.

    A structure with factor, first and second; the last two are 0 but for COLA.
    """
    factors = native.StepFactors()
    library.drift_factors(factors, cosmology, stepper, cola_exponent, start, end, at)
    return factors


def kick_factors(cosmology: native.Structure, start: float, end: float, at: float, *, stepper: int = Stepper.FASTPM,
                 cola_exponent: float = COLA_EXPONENT) -> native.Structure:
    """v += factor F + first psi1 + second psi2 from a scale factor to another, F = -grad inverse-Laplacian delta known at the time `at`."""
    factors = native.StepFactors()
    library.kick_factors(factors, cosmology, stepper, cola_exponent, start, end, at)
    return factors


def linear_steps(count: int, start: float, end: float) -> np.ndarray:
    """Scale factors of `count` equal steps of a: count + 1 of them, the first and last exactly `start` and `end`."""
    scale_factors = np.empty(count + 1)
    library.linear_steps(scale_factors, count + 1, start, end)
    return scale_factors


def logarithmic_steps(count: int, start: float, end: float) -> np.ndarray:
    """Scale factors of `count` equal steps of ln a: count + 1 of them, the first and last exactly `start` and `end`."""
    scale_factors = np.empty(count + 1)
    library.logarithmic_steps(scale_factors, count + 1, start, end)
    return scale_factors
