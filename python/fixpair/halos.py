"""Friends of friends, catalogues, spherical overdensities. Positions and lengths in one unit, L the side of the box.

::

    labels = halos.fof_labels(position, box_size, halos.linking_length(0.2, box_size, len(position)))
    mass = halos.particle_mass(cosmology.omega_m, box_size, len(position))
    catalogue = halos.halos(labels, position, box_size, velocity=velocity, n_min=20, particle_mass=mass)
"""

import ctypes

import numpy as np

from . import native
from ._arrays import Particles, optional_triples, output, triples, vector
from ._library import library, twin
from .native import OverdensityDefinition
from .threads import current
from .workspace import scratch

HALO = np.dtype(native.Halo)
"""One group: label, members, mass, centre, velocity, radius, extent, velocity_dispersion."""
HALO_SUMS = np.dtype(native.HaloSums)
"""Sums over particles of one group, to be merged with those of other processes."""
SPHERE = np.dtype(native.Sphere)
"""What lies around a centre above a density: members, mass, radius."""


def linking_length(b: float, box_size: float, particles: int) -> float:
    """The linking length l = b L/N^(1/3), in the unit of the box; b is 0.2 by custom."""
    length = ctypes.c_double()
    library.linking_length(length, b, box_size, particles)
    return length.value


def fof_labels(position: Particles, box_size: float, linking_length: float, *, ids: np.ndarray | None = None,
               out: np.ndarray | None = None) -> np.ndarray:
    """The label of each particle, uint64: the smallest id in its group. Particles are friends within the linking length, periodically.

    ids: uint64, all different; the particle's number if None. linking_length: from L/10^6 to L/2.
    """
    places = triples(position, "position")
    labels = output(out, "out", places.particles, np.uint64)
    ids = None if ids is None else vector(ids, "ids", np.uint64, places.particles)
    with scratch(twin("fof_labels_scratch", places.real), places.particles) as (memory, size):
        twin("fof_labels", places.real)(labels, labels.size, places.structure, ids, 0 if ids is None else ids.size, box_size,
                                        linking_length, memory, size, current())
    return labels


def fof_merge(pairs: np.ndarray) -> np.ndarray:
    """From pairs of labels that belong to one group, uint64 (M, 2), to a map (entries, 2): label, final label."""
    pairs = vector(pairs, "pairs", np.uint64)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise ValueError(f"pairs must have the shape (M, 2), not {pairs.shape}")
    entries = ctypes.c_size_t()
    merged = np.empty((2 * len(pairs), 2), np.uint64)
    library.fof_merge(merged, len(merged), entries, pairs, len(pairs))
    return merged[:entries.value].copy()


def fof_relabel(labels: np.ndarray, merged: np.ndarray) -> np.ndarray:
    """Replaces labels by their final ones, in place, where the map of :func:`fof_merge` holds them."""
    labels, merged = vector(labels, "labels", np.uint64, write=True), _map(merged)
    library.fof_relabel(labels, labels.size, merged, len(merged), current())
    return labels


def _map(merged: np.ndarray) -> np.ndarray:
    merged = vector(merged, "merged", np.uint64)
    if merged.ndim != 2 or merged.shape[1] != 2:
        raise ValueError(f"a map must have the shape (entries, 2), not {merged.shape}")
    return merged


def particle_mass(omega_m: float, box_size: float, particles: int) -> float:
    """Mass of a particle in Msun/h: 2.77536627e11 Omega_m L^3/N, L in Mpc/h."""
    mass = ctypes.c_double()
    library.particle_mass(mass, omega_m, box_size, particles)
    return mass.value


def halo_count(labels: np.ndarray, n_min: int = 20) -> int:
    """How many groups have n_min particles and more."""
    labels = vector(labels, "labels", np.uint64)
    count = ctypes.c_size_t()
    with scratch(library.halos_scratch, labels.size) as (memory, size):
        library.halo_count(count, labels, labels.size, n_min, memory, size, current())
    return count.value


def halos(labels: np.ndarray, position: Particles, box_size: float, *, velocity: Particles | None = None, n_min: int = 20,
          particle_mass: float = 1.0) -> np.recarray:
    """Catalogue of the groups of n_min particles and more, of type HALO: the largest first."""
    places = triples(position, "position")
    labels = vector(labels, "labels", np.uint64, places.particles)
    speed = optional_triples(velocity, "velocity", places)
    found, count = np.empty(places.particles // max(n_min, 1), HALO), ctypes.c_size_t()
    with scratch(library.halos_scratch, labels.size) as (memory, size):
        twin("halos", places.real)(found, found.size, count, labels, labels.size, places.structure, speed, box_size, n_min,
                                   particle_mass, memory, size, current())
    return found[:count.value].copy().view(np.recarray)


def halo_sums(labels: np.ndarray, position: Particles, box_size: float, *, velocity: Particles | None = None, n_min: int = 20,
              merged: np.ndarray | None = None) -> np.ndarray:
    """Sums over the particles of each group that has n_min of them here, or whose label is in the map, of type HALO_SUMS."""
    places = triples(position, "position")
    labels = vector(labels, "labels", np.uint64, places.particles)
    merged = None if merged is None else _map(merged)
    speed = optional_triples(velocity, "velocity", places)
    entries = 0 if merged is None else len(merged)
    sums, count = np.empty(places.particles // max(n_min, 1) + entries, HALO_SUMS), ctypes.c_size_t()
    with scratch(library.halos_scratch, labels.size) as (memory, size):
        twin("halo_sums", places.real)(sums, sums.size, count, labels, labels.size, places.structure, speed, box_size, n_min, merged,
                                       entries, memory, size, current())
    return sums[:count.value].copy()


def halo_sums_merge(sums: np.ndarray, box_size: float) -> np.ndarray:
    """Adds up sums of the same label, of all processes: one for each group, in order of labels."""
    sums = vector(sums, "sums", HALO_SUMS).copy()
    groups = ctypes.c_size_t()
    library.halo_sums_merge(sums, sums.size, groups, box_size)
    return sums[:groups.value].copy()


def halos_finish(sums: np.ndarray, box_size: float, *, n_min: int = 20, particle_mass: float = 1.0) -> np.recarray:
    """Turns sums of whole groups into a catalogue, ordered as by :func:`halos`."""
    sums = vector(sums, "sums", HALO_SUMS)
    found, count = np.empty(sums.size, HALO), ctypes.c_size_t()
    library.halos_finish(found, found.size, count, sums, sums.size, box_size, n_min, particle_mass)
    return found[:count.value].copy().view(np.recarray)


def overdensity(definition: int, times: float, cosmology: native.Structure, a: float) -> float:
    """Delta over the mean density of matter: of `times` the mean, `times` the critical density, or virial (Bryan & Norman 1998)."""
    delta = ctypes.c_double()
    library.overdensity(delta, definition, times, cosmology, a)
    return delta.value


def spheres(centres: np.ndarray, overdensities: np.ndarray, position: Particles, box_size: float, *,
            particles_total: int | None = None, particle_mass: float = 1.0, n_min: int = 20) -> np.recarray:
    """Grows spheres about centres (M, 3) until their mean density has fallen to Delta times that of matter.

    Returns (M, overdensities) of type SPHERE; all 0 where the centre is not that dense. M = (4 pi/3) R^3 Delta rho_m holds exactly.
    """
    places, centres = triples(position, "position"), _centres(centres)
    overdensities = vector(overdensities, "overdensities")
    found = np.empty((len(centres), overdensities.size), SPHERE)
    with scratch(twin("spheres_scratch", places.real), places.particles) as (memory, size):
        twin("spheres", places.real)(found, found.size, centres, len(centres), overdensities, overdensities.size, places.structure,
                                     box_size, places.particles if particles_total is None else particles_total, particle_mass, n_min,
                                     memory, size, current())
    return found.view(np.recarray)


def refine_centres(centres: np.ndarray, radii: np.ndarray, position: Particles, box_size: float, *, factor: float = 0.975,
                   n_min: int = 100) -> np.ndarray:
    """Moves centres (M, 3), in place, to the densest place near them by shrinking spheres (Power et al. 2003, astro-ph/0201544).

    radii: of the first spheres, about twice the radius of a halo.
    """
    places, centres = triples(position, "position"), _centres(centres, write=True)
    radii = vector(radii, "radii", length=len(centres))
    with scratch(twin("spheres_scratch", places.real), places.particles) as (memory, size):
        twin("refine_centres", places.real)(centres, len(centres), radii, places.structure, box_size, factor, n_min, memory, size,
                                            current())
    return centres


def _centres(centres: np.ndarray, write: bool = False) -> np.ndarray:
    centres = vector(centres, "centres", write=write)
    if centres.ndim != 2 or centres.shape[1] != 3:
        raise ValueError(f"centres must have the shape (M, 3), not {centres.shape}")
    return centres


__all__ = [
    "HALO", "HALO_SUMS", "SPHERE", "OverdensityDefinition", "fof_labels", "fof_merge", "fof_relabel", "halo_count", "halo_sums",
    "halo_sums_merge", "halos", "halos_finish", "linking_length", "overdensity", "particle_mass", "refine_centres", "spheres",
]
