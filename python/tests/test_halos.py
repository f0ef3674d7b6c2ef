"""Halos: clumps are found, and processes that share them agree."""

import numpy as np
import pytest

import fixpair
from fixpair import OverdensityDefinition, halos
from samples import BOX

CENTRES = np.array([[50.0, 60.0, 70.0], [199.5, 100.0, 0.5]])


def clumps(dtype):
    """Two clumps, of which one lies across the border of the box, and particles that are alone."""
    rng = np.random.default_rng(8)
    near = [(centre + rng.uniform(-1, 1, (count, 3))) % BOX for centre, count in zip(CENTRES, (40, 60))]
    lattice = np.stack(np.meshgrid(*[np.arange(6) * BOX / 6 + 10] * 3, indexing="ij"), -1).reshape(-1, 3)
    return np.ascontiguousarray(np.concatenate([*near, lattice]).astype(dtype))


def test_two_clumps_are_two_halos(dtype):
    x = clumps(dtype)
    v = np.zeros_like(x)
    v[:40, 0], v[40:100, 1] = 100, -50
    labels = halos.fof_labels(x, BOX, 1.5)
    assert (labels[:40] == 0).all() and (labels[40:100] == 40).all() and halos.halo_count(labels) == 2
    found = halos.halos(labels, x, BOX, velocity=v, n_min=20, particle_mass=2.0)
    assert found.members.tolist() == [60, 40] and found.mass.tolist() == [120.0, 80.0]
    assert np.abs((found.centre - CENTRES[::-1] + BOX / 2) % BOX - BOX / 2).max() < 0.3
    assert found.velocity == pytest.approx(np.array([[0, -50, 0], [100, 0, 0]]), abs=1e-4)


def test_ids_are_the_labels():
    x, ids = clumps(np.float64), np.arange(316, dtype=np.uint64)[::-1].copy()
    labels = halos.fof_labels(x, BOX, 1.5, ids=ids)
    assert (labels[:40] == ids[:40].min()).all()
    with pytest.raises(TypeError, match="uint64"):
        halos.fof_labels(x, BOX, 1.5, ids=ids.astype(np.int64))


def test_parts_of_a_box_have_the_halos_of_the_whole(dtype):
    x = clumps(dtype)
    labels = halos.fof_labels(x, BOX, 1.5)
    whole = halos.halos(labels, x, BOX, n_min=20)
    # Two processes named the second clump differently.
    parts = [np.arange(0, 70), np.arange(70, len(x))]
    named = labels.copy()
    named[70:100] = 70
    merged = halos.fof_merge(np.array([[40, 70]], np.uint64))
    assert merged.tolist() == [[40, 40], [70, 40]]
    sums = np.concatenate([halos.halo_sums(named[part], x[part], BOX, n_min=20, merged=merged) for part in parts])
    found = halos.halos_finish(halos.halo_sums_merge(sums, BOX), BOX, n_min=20)
    assert np.array_equal(found.members, whole.members) and np.array_equal(found.label, whole.label)
    assert found.centre == pytest.approx(whole.centre, abs=1e-10)
    assert np.array_equal(halos.fof_relabel(named, merged), labels)


def test_spheres_and_centres(dtype):
    x, centres = clumps(dtype), CENTRES + 0.4
    moved = centres.copy()
    assert halos.refine_centres(moved, np.full(2, 3.0), x, BOX, n_min=10) is moved
    assert (np.linalg.norm(moved - CENTRES, axis=1) < np.linalg.norm(centres - CENTRES, axis=1)).all()
    found = halos.spheres(CENTRES, [200.0, 500.0], x, BOX, particle_mass=3.0, n_min=5)
    assert found.shape == (2, 2) and (found.mass == 3.0 * found.members).all()
    # M = (4 pi/3) R^3 Delta rho_m.
    density = 3.0 * len(x) / BOX**3 * np.array([200.0, 500.0])
    assert found.mass == pytest.approx(4 * np.pi / 3 * found.radius**3 * density, rel=1e-12)


def test_masses_and_densities():
    universe = fixpair.Cosmology(omega_m=0.3, omega_de=0.7)
    assert halos.particle_mass(0.3, 100.0, 10**6) == pytest.approx(2.77536627e11 * 0.3, rel=1e-8)
    assert halos.overdensity(OverdensityDefinition.CRITICAL, 200.0, universe, 1.0) == pytest.approx(200 / 0.3, rel=1e-12)
    assert halos.overdensity(OverdensityDefinition.VIRIAL, 0.0, universe, 1.0) == pytest.approx(337, abs=1)
