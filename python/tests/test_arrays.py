"""Arrays are used where they are, or refused: nothing is copied behind the caller's back."""

import tracemalloc

import numpy as np
import pytest

import fixpair
from fixpair import _arrays, native
from samples import BOX, address, numbers, scattered


def test_particles_are_where_the_array_has_them(dtype):
    array = np.zeros((10, 3), dtype)
    found = _arrays.triples(array, "x")
    assert (found.structure.x, found.structure.y, found.structure.stride) == (address(array), address(array) + dtype.itemsize, 3)
    assert all(np.shares_memory(column, array) for column in found.columns)


def test_particles_may_be_fields_of_structured_arrays(dtype):
    record = np.dtype([("id", np.uint64), ("pos", dtype, 3), ("mass", dtype), ("vel", dtype, 3)])
    particles = np.zeros(200, record)
    particles["pos"] = scattered(200, dtype)
    plain = particles["pos"].copy()
    found = _arrays.triples(particles["pos"], "pos")
    assert found.structure.x == address(particles) + 8 and found.structure.stride == record.itemsize // dtype.itemsize
    meshes = [fixpair.deposit(np.zeros((8, 8, 8), dtype), each, BOX) for each in (particles["pos"], plain)]
    assert np.array_equal(*meshes)


def test_particles_may_be_three_arrays_of_any_stride(dtype):
    plain = scattered(100, dtype)
    wide = np.zeros((3, 200), dtype)
    wide[:, ::2] = plain.T
    meshes = [fixpair.deposit(np.zeros((8, 8, 8), dtype), each, BOX) for each in (tuple(wide[:, ::2]), np.asfortranarray(plain), plain)]
    assert np.array_equal(meshes[0], meshes[2]) and np.array_equal(meshes[1], meshes[2])


def test_meshes_may_have_any_strides_forwards(dtype):
    x = scattered(300, dtype)
    whole = fixpair.deposit(np.zeros((8, 8, 8), dtype), x, BOX)
    padded = np.full((8, 9, 12), 7, dtype)
    padded[:, :8, :8] = 0
    fixpair.deposit(padded[:, :8, :8], x, BOX)
    assert np.array_equal(padded[:, :8, :8], whole)
    assert (padded[:, 8] == 7).all() and (padded[:, :, 8:] == 7).all()
    turned = np.zeros((8, 8, 8), dtype).transpose(2, 1, 0)
    assert np.array_equal(fixpair.deposit(turned, x, BOX), whole)


def test_calls_take_no_memory_for_arrays(dtype):
    x, mesh, values = scattered(100_000, dtype), np.zeros((32, 32, 32), dtype), np.zeros(100_000, dtype)
    with fixpair.Workspace():
        fixpair.deposit(mesh, x, BOX)
        tracemalloc.start()
        fixpair.deposit(mesh, x, BOX)
        fixpair.read_out(mesh, x, BOX, out=values)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    # Objects of Python, and not the 1.2 MB of positions.
    assert peak < 50_000


def test_results_go_where_they_are_asked_to(dtype):
    out = np.empty((8, 8, 5), np.result_type(dtype, np.complex64))
    assert fixpair.white_modes(8, fixpair.Realisation(3), out=out) is out
    mesh, values = numbers(512).reshape(8, 8, 8).astype(dtype), np.zeros((50, 2), dtype)
    x = scattered(50, dtype)
    fixpair.read_out(mesh, x, BOX, out=values[:, 1])
    assert (values[:, 0] == 0).all() and np.array_equal(values[:, 1], fixpair.read_out(mesh, x, BOX))


@pytest.mark.parametrize("bad, error", [
    (lambda x: x.astype(np.float16), TypeError), (lambda x: x.astype(np.int64), TypeError),
    (lambda x: x.astype(x.dtype.newbyteorder()), TypeError), (lambda x: x.tolist(), ValueError),
    (lambda x: x[:, :2], ValueError), (lambda x: x.T, ValueError), (lambda x: x[::-1], ValueError), (lambda x: x[:5], ValueError),
])
def test_particles_that_cannot_be_used_as_they_are_are_refused(bad, error, dtype):
    mesh = np.zeros((8, 8, 8), dtype)
    with pytest.raises((error, TypeError)):
        fixpair.deposit(mesh, bad(scattered(20, dtype)), BOX, weights=np.ones(20, dtype))
    assert not mesh.any()


def test_precisions_are_not_mixed():
    with pytest.raises(TypeError, match="precisions"):
        fixpair.deposit(np.zeros((8, 8, 8), np.float64), scattered(5, np.float32), BOX)
    with pytest.raises(TypeError, match="precisions"):
        fixpair.initial_conditions(fixpair.Conditions(1), fixpair.Fft(8, np.float32), position=np.zeros((512, 3)))


def test_memory_that_cannot_be_written_is_refused(dtype):
    mesh = np.zeros((8, 8, 8), dtype)
    mesh.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        fixpair.deposit(mesh, scattered(5, dtype), BOX)
    odd = np.zeros(3 * 5 * dtype.itemsize + 1, np.uint8)[1:].view(dtype).reshape(5, 3)
    with pytest.raises(ValueError, match="aligned"):
        fixpair.pm.drift(odd, odd.copy(), BOX)


@pytest.mark.parametrize("shape", [(8, 8), (8, 8, 9), (8, 4, 8)])
def test_meshes_of_another_shape_are_refused(shape, dtype):
    with pytest.raises(ValueError):
        fixpair.deposit(np.zeros(shape, dtype), scattered(5, dtype), BOX)


def test_meshes_of_another_kind_are_refused():
    with pytest.raises(ValueError, match="complex"):
        fixpair.noise.impose(np.zeros((8, 8, 8)), fixpair.Realisation(1))
    with pytest.raises(ValueError, match="laid out"):
        fixpair.pm.interlace(np.zeros((8, 8, 5), complex), np.zeros((8, 8, 6), complex)[:, :, :5])
    with pytest.raises(fixpair.MeshSizeError):
        fixpair.noise.impose(np.zeros((7, 7, 4), complex), fixpair.Realisation(1))


def test_vectors_of_another_type_are_refused_and_sequences_are_read():
    cosmology = fixpair.Cosmology()
    with pytest.raises(TypeError, match="float64"):
        fixpair.cosmology.expansion(np.ones(3, np.float32), cosmology)
    with pytest.raises(ValueError, match="contiguous"):
        fixpair.cosmology.expansion(np.ones(6)[::2], cosmology)
    assert fixpair.cosmology.expansion([1.0], cosmology) == 1.0
    assert fixpair.cosmology.expansion(1, cosmology) == 1.0


def test_scalars_of_numpy_are_numbers():
    length = fixpair.halos.linking_length(np.float32(0.25), np.float64(100.0), np.int64(1000))
    assert length == fixpair.halos.linking_length(0.25, 100.0, 1000) == 2.5


def test_structures_refuse_members_that_they_do_not_have():
    with pytest.raises(AttributeError, match="omega_m"):
        fixpair.Cosmology(omega_matter=0.3)
    conditions = fixpair.Conditions(1)
    with pytest.raises(AttributeError, match="amplitude"):
        conditions.realisation.amplitudes = 1
    assert "omega_m=0.27" in repr(fixpair.Cosmology())


def test_structures_keep_the_arrays_that_they_point_to():
    def conditions():
        k = np.geomspace(1e-4, 10, 500)
        power = fixpair.cosmology.linear_power(k, fixpair.Cosmology(), fixpair.Linear(sigma8=0.7))
        return fixpair.Conditions(1, linear=fixpair.Linear(k=k, power=power))
    mine = conditions()
    garbage = [np.full(500, np.nan) for _ in range(100)]
    assert len(garbage) == 100
    # Rows of the fit, interpolated between.
    assert fixpair.cosmology.linear_sigma(8.0, mine.cosmology, mine.linear) == pytest.approx(0.7, rel=1e-4)


def test_lengths_follow_from_arrays():
    linear, binning = fixpair.Linear(k=[0.1, 0.2, 0.3], power=[3.0, 2.0, 1.0]), fixpair.Binning([1, 4, 9])
    for structure, member in ((linear, "rows"), (binning, "edges_len"), (fixpair.Conditions(1), "rows_len")):
        with pytest.raises(AttributeError, match="follows from"):
            setattr(structure, member, 1000)
    with pytest.raises(ValueError, match="3 elements"):
        linear.k = [0.1, 0.2]
    binning.edges = np.array([1, 4, 9, 16], np.uint64)
    assert binning.edges_len == 4 and binning.lengths() == (3, 3, binning.lengths()[2])


def test_bricks_show_memory_without_copies(dtype):
    brick = fixpair.Brick.slab(8, 2, 3, native.Space.FOURIER)
    memory = np.zeros(brick.reals, dtype)
    modes = brick.view(memory)
    assert modes.shape == brick.shape == (3, 8, 5) and np.shares_memory(modes, memory)
    with pytest.raises(ValueError, match="hold"):
        brick.view(memory[:-1])
