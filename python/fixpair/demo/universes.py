"""Universes of the four types, and what is measured in each."""

from dataclasses import dataclass, field
from typing import NamedTuple
from collections.abc import Callable

import numpy as np

from .. import cosmology, estimate, initial, pm
from ..cosmology import Linear
from ..estimate import Binning, Sums
from ..fft import Fft, next_side
from ..initial import Conditions, initial_conditions
from ..native import Amplitude, Compensation, Phase, Window
from ..noise import white_modes
from ..pm import Gravity, deposit, evolve

START, END, STEPS = 1 / 33, 0.5, 10
"""Scale factors of a run: from z = 32 to z = 1."""
THRESHOLD = 1.5
"""Cells denser than this many times the mean are the tracers."""
F_NL = (0.0, 100.0)


class Kind(NamedTuple):
    """Which universe of a seed."""

    amplitude: Amplitude
    phase: Phase
    f_nl: float


KINDS = [Kind(amplitude, phase, f_nl) for amplitude in (Amplitude.NORMAL, Amplitude.FIXED) for phase in Phase for f_nl in F_NL]


class Measured(NamedTuple):
    """P of shells (Mpc/h)^3: linear matter at z = 32, matter and its cross spectrum with tracers at z = 1. f_NL of the potential."""

    linear: np.ndarray
    matter: np.ndarray
    cross: np.ndarray
    f_nl: float


@dataclass
class Laboratory:
    """Transforms, bins and tables that all universes share: size cells and particles a side, a box of box_size Mpc/h."""

    size: int
    box_size: float
    linear: Linear = field(default_factory=lambda: Linear(sigma8=0.8))

    def __post_init__(self) -> None:
        self.conditions = Conditions(box_size=self.box_size, linear=self.linear)
        self.single, self.double, self.fine = Fft(self.size, np.float32), Fft(self.size), Fft(next_side(3 * self.size // 2))
        self.edges = estimate.edges_uniform(self.size // 4)
        self.binning = Binning(self.edges)
        universe = self.conditions.cosmology
        self.amplitudes = cosmology.potential_amplitude_table(self.size, self.box_size, universe, self.linear)
        self.alphas = cosmology.alpha_table(self.size, self.box_size, universe, self.linear, 1 / START - 1)
        bins, _ = estimate.power_sums(Sums.zeros(self.binning), [white_modes(self.size, self.conditions.realisation)]).read()
        self.modes = bins.count.astype(float)
        self.k = bins.first * (2 * np.pi / self.box_size)
        self._bispectra()

    def _bispectra(self) -> None:
        """Triangles of all shells, and the weights with which they estimate f_NL.

        B = 2 f_NL (P_i P_j + P_j P_k + P_k P_i) of the potential; the variance of B goes as P_i P_j P_k over the number of triples.
        P is taken as constant in a shell, which puts f_NL some 2% high.
        """
        self.triangles = estimate.closed_triangles(self.edges)
        self.counts = estimate.triangle_counts(self.triangles, self.edges, self.size)
        fixed = self.potential(Kind(Amplitude.FIXED, Phase.ORIGINAL, 0.0), 0)
        _, values = estimate.power_sums(Sums.zeros(self.binning), [self.double.modes(fixed)]).multipoles(self.box_size**3)
        first, second, third = values[0, :, 0][self.triangles.astype(int)].T
        self.shape = 2 * (first * second + second * third + third * first)
        weights = self.shape * self.counts / (first * second * third)
        self.weights = weights / (weights * self.shape).sum()

    def at(self, kind: Kind, seed: int) -> Conditions:
        """The conditions of one universe."""
        conditions = self.conditions
        conditions.realisation.seed = seed
        conditions.realisation.amplitude, conditions.realisation.phase, conditions.f_nl = kind
        return conditions

    def potential(self, kind: Kind, seed: int) -> np.ndarray:
        """Modes of the primordial potential: noise, fixed, inverted, coloured, and f_NL on a mesh where products do not alias."""
        data = self.double.mesh()
        modes = white_modes(self.size, self.at(kind, seed).realisation, amplitude=self.amplitudes, out=self.double.modes(data))
        initial.add_local(modes, kind.f_nl, 0.0, self.fine)
        return data

    def measure(self, kind: Kind, seed: int) -> Measured:
        """Makes one universe, runs it to z = 1, and measures it."""
        volume, cells = self.box_size**3, self.size**3
        data = self.potential(kind, seed)
        sums = estimate.bispectrum(None, self.triangles, self.edges, data, self.double)
        b = estimate.bispectrum_normalise(estimate.bispectrum_values(sums), self.counts, self.size, self.box_size)
        density = initial.scale_modes(self.double.modes(data), self.alphas)
        _, linear = estimate.power_sums(Sums.zeros(self.binning), [density]).multipoles(volume)

        conditions = self.at(kind, seed)
        position, velocity = initial_conditions(conditions, self.single)
        gravity = Gravity(self.box_size, cosmology=conditions.cosmology)
        evolve(position, velocity, gravity, pm.linear_steps(STEPS, START, END), self.single)
        matter, tracers = self.single.mesh(), self.single.mesh()
        cells_of_matter, cells_of_tracers = self.single.cells(matter), self.single.cells(tracers)
        deposit(cells_of_matter, position, self.box_size)
        dense = cells_of_matter > THRESHOLD
        cells_of_tracers[...] = dense / max(dense.mean(), 1 / cells)
        fields = [self.single.forward(matter), self.single.forward(tracers)]
        _, values = estimate.power_sums(Sums.zeros(self.binning, 2), fields, [(0, 0), (0, 1)], compensation=[
            Compensation.WINDOW + Window.CIC, Compensation.NONE]).multipoles(volume / cells**2)
        return Measured(linear[0, :, 0], values[0, :, 0], values[1, :, 0], float(self.weights @ b))


def measure_all(laboratory: Laboratory, seeds: range, tell: Callable[[int, int], None]) -> dict[Kind, list[Measured]]:
    """All kinds of all seeds; tell(done, all) hears of each universe."""
    measured: dict[Kind, list[Measured]] = {kind: [] for kind in KINDS}
    for seed in seeds:
        for kind in KINDS:
            measured[kind].append(laboratory.measure(kind, seed))
            tell(sum(map(len, measured.values())), len(seeds) * len(KINDS))
    return measured
