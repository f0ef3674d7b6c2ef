"""Background, growth, linear spectra and the Poisson equation. Lengths in Mpc/h, k in h/Mpc, P in (Mpc/h)^3, velocities in km/s."""

import ctypes
from typing import Any

import numpy as np

from . import native
from ._arrays import output, vector
from ._library import library
from ._members import Members
from .native import Convention, LinearSource, Normalisation
from .threads import current


class Cosmology(Members, native.Cosmology):
    """A homogeneous universe and the tilt of its primordial spectrum; that of GOLIAT (Avila & Adame 2022) but for what is given.

    By name: omega_m (0.27), omega_de (0.73), omega_r (0), omega_b (0.044), h (0.7), n_s (0.96), w0 (-1), wa (0), t_cmb in K. Densities are today's
    over the critical density; curvature is 1 minus their sum. w(a) = w0 + wa (1 - a).
    """

    def __init__(self, **members: float):
        super().__init__()
        library.cosmology_init(self)
        self._set(members)


class Linear(Members, native.Linear):
    """The linear power spectrum of z = 0, as you have it.

    ::

        Linear(k=k, power=power)                    # rows of P(k), as they are
        Linear(k=k, power=power, sigma8=0.8)        # normalised
        Linear(k=k, transfer=t, a_s=2.1e-9)         # rows of T(k), in any unit
        Linear(sigma8=0.8)                          # the fit of Eisenstein & Hu 1998; smooth=True without oscillations

    k: h/Mpc, increasing. sigma8, amplitude (A of P = A k^n_s T^2) or a_s (at 0.05/Mpc): what it is normalised to, one of them.
    Between rows ln P is interpolated in ln k by monotone cubics. Arrays are float64 and kept, not copied.
    """

    _pointers = ("k", "value")
    _lengths = ("rows",)

    def __init__(self, *, k: Any = None, power: Any = None, transfer: Any = None, sigma8: float | None = None,
                 amplitude: float | None = None, a_s: float | None = None, smooth: bool = False):
        super().__init__()
        amounts = {Normalisation.SIGMA8: sigma8, Normalisation.AMPLITUDE: amplitude, Normalisation.A_S: a_s}
        given = [(choice, amount) for choice, amount in amounts.items() if amount is not None]
        if len(given) > 1 or (power is not None and transfer is not None):
            raise ValueError("give one of power and transfer, and one of sigma8, amplitude and a_s")
        rows = power if power is not None else transfer
        if (k is None) != (rows is None):
            raise ValueError("k comes with power or transfer, and they with k")
        if not given and power is None:
            raise ValueError("a transfer function or a fit needs sigma8, amplitude or a_s")
        self.struct_size = ctypes.sizeof(native.Linear)
        self.normalisation, self.amount = given[0] if given else (Normalisation.AS_GIVEN, 0.0)
        if rows is None:
            self.source = LinearSource.EISENSTEIN_HU_SMOOTH if smooth else LinearSource.EISENSTEIN_HU
            return
        self.source = LinearSource.POWER if power is not None else LinearSource.TRANSFER
        self._count("rows", np.size(k))
        self.k, self.value = k, rows

    def _point(self, name: str, value: Any) -> tuple[int, np.ndarray]:
        column = vector(value, name, length=self.rows)
        return native.address(column), column


class Species(Members, native.Species):
    """One species of matter, cold dark matter or baryons, from columns of CAMB or CLASS at the time of the particles.

    k in h/Mpc; matter T_m; density T_s; velocity V_s (CAMB's v_newtonian_cdm or _baryon); reference: what the linear spectrum scaled back
    with D(a) stands for, T_m(k, z = 0) D(a), or None for T_m itself. Columns are positive float64 arrays in one unit, kept and not copied.
    """

    _pointers = ("k", "matter", "density", "velocity", "reference")
    _lengths = ("rows",)

    def __init__(self, k: Any, matter: Any, density: Any, velocity: Any, reference: Any = None):
        super().__init__()
        library.species_init(self)
        self._count("rows", np.size(k))
        self._set({"k": k, "matter": matter, "density": density, "velocity": velocity, "reference": reference})

    def _point(self, name: str, value: Any) -> tuple[int | None, np.ndarray | None]:
        if value is None and name == "reference":
            return None, None
        column = vector(value, name, length=self.rows)
        return native.address(column), column


def radiation_density(t_cmb: float, n_eff: float, h: float) -> float:
    """Omega_r of photons at t_cmb (K) and n_eff (3.046) massless neutrinos."""
    omega_r = ctypes.c_double()
    library.radiation_density(omega_r, t_cmb, n_eff, h)
    return omega_r.value


def expansion(a: Any, cosmology: native.Structure, *, out: np.ndarray | None = None) -> np.ndarray:
    """E(a) = H(a)/H0 of scale factors in 1e-10 to 10; H0 is 100 km/s per Mpc/h."""
    a = vector(a, "a")
    out = output(out, "out", a.shape)
    library.expansion(out, a, a.size, cosmology)
    return out


def growth_factors(a: Any, cosmology: native.Structure) -> np.recarray:
    """Growth functions at scale factors in 1e-5 to 10: a record array with d, f, d2, f2, d3a, f3a, d3b, f3b, d3c, f3c.

    D = 1 today, f = dlnD/dlna; D2 is near -3/7 D^2. Displacements are x = q - D grad phi1 + D2 grad phi2 + third order.
    """
    a = vector(a, "a")
    growth = np.empty(a.shape, np.dtype(native.Growth))
    library.growth_factors(growth, a, a.size, cosmology)
    return growth.view(np.recarray)


def growth_suppression(cosmology: native.Structure) -> float:
    """g(z_rad)/g(0), g = (1 + z) D: f_NL(LSS) is this times f_NL(CMB)."""
    ratio = ctypes.c_double()
    library.growth_suppression(ratio, cosmology)
    return ratio.value


def linear_power(k: Any, cosmology: native.Structure, linear: native.Structure, redshift: float = 0.0, *,
                 out: np.ndarray | None = None) -> np.ndarray:
    """P(k) D^2(z) in (Mpc/h)^3."""
    k = vector(k, "k")
    out = output(out, "out", k.shape)
    library.linear_power(out, k, k.size, cosmology, linear, redshift)
    return out


def linear_transfer(k: Any, cosmology: native.Structure, linear: native.Structure, *,
                    out: np.ndarray | None = None) -> np.ndarray:
    """T(k) of a spectrum, 1 for k -> 0."""
    k = vector(k, "k")
    out = output(out, "out", k.shape)
    library.linear_transfer(out, k, k.size, cosmology, linear)
    return out


def linear_sigma(radius: float, cosmology: native.Structure, linear: native.Structure) -> float:
    """sigma(R), the r.m.s. of the linear density in spheres of radius R (Mpc/h) at z = 0: 8 gives sigma8."""
    sigma = ctypes.c_double()
    library.linear_sigma(sigma, radius, cosmology, linear)
    return sigma.value


def alpha(k: Any, cosmology: native.Structure, linear: native.Structure, redshift: float = 0.0,
          convention: int = Convention.CMB, *, out: np.ndarray | None = None) -> np.ndarray:
    """alpha(k, z) of delta = alpha Phi: (2/3) (c/H0)^2 k^2 T(k) D(z)/Omega_m, over g(z_rad)/g(0) in the CMB convention."""
    k = vector(k, "k")
    out = output(out, "out", k.shape)
    library.alpha(out, k, k.size, cosmology, linear, redshift, convention)
    return out


def mode_table_length(n: int) -> int:
    """Entries of a table by |n|^2 for a mesh of side n: 3 (n/2)^2 + 1."""
    length = ctypes.c_size_t()
    library.mode_table_length(length, n)
    return length.value


def potential_amplitude_table(n: int, box_size: float, cosmology: native.Structure, linear: native.Structure,
                              convention: int = Convention.CMB) -> np.ndarray:
    """sqrt(P_Phi(k)/L^3) by integer |n|^2, n = k L/(2 pi): what unit modes are multiplied by to become Phi. P_Phi = P/alpha^2 at z = 0."""
    table = np.empty(mode_table_length(n))
    library.potential_amplitude_table(table, table.size, n, box_size, cosmology, linear, convention, current())
    return table


def alpha_table(n: int, box_size: float, cosmology: native.Structure, linear: native.Structure, redshift: float = 0.0,
                convention: int = Convention.CMB) -> np.ndarray:
    """alpha(k, z) by integer |n|^2: what modes of Phi are multiplied by to become the linear density."""
    table = np.empty(mode_table_length(n))
    library.alpha_table(table, table.size, n, box_size, cosmology, linear, redshift, convention, current())
    return table


def species_table(species: native.Structure, ratio: int, n: int, box_size: float) -> np.ndarray:
    """One :class:`~fixpair.Ratio` of a species' columns by integer |n|^2, for :func:`fixpair.initial.scale_modes`."""
    table = np.empty(mode_table_length(n))
    library.species_table(table, table.size, species, ratio, n, box_size, current())
    return table
