"""Threads and workspaces change nothing but the time that it takes."""

import threading

import numpy as np
import pytest

import fixpair
from samples import BOX, scattered


def work(dtype):
    """Modes, particles and a deposit: something of every kind of kernel."""
    fft = fixpair.Fft(16, dtype)
    conditions = fixpair.Conditions(3, box_size=BOX, f_nl=1000.0, amplitude=fixpair.Amplitude.FIXED)
    position, velocity = fixpair.initial_conditions(conditions, fft, fixpair.Fft(24, dtype))
    fixpair.evolve(position, velocity, fixpair.Gravity(BOX), fixpair.pm.linear_steps(2, 1 / 33, 0.3), fft)
    mesh = fixpair.deposit(np.zeros((16, 16, 16), dtype), position, BOX, window=fixpair.Window.PCS)
    labels = fixpair.halos.fof_labels(position, BOX, 8.0)
    return position, velocity, mesh, labels


def same(first, second):
    return all(np.array_equal(a, b) for a, b in zip(first, second))


def test_any_number_of_threads_gives_the_same_bits(dtype):
    alone = work(dtype)
    for count in (1, 2, 5):
        with fixpair.Threads(count) as threads:
            threads.self_test()
            assert same(work(dtype), alone)


def test_a_workspace_is_used_again_and_gives_the_same_bits(dtype):
    alone = work(dtype)
    with fixpair.Workspace() as workspace:
        assert same(work(dtype), alone)
        size = workspace.size
        assert size > 0 and same(work(dtype), alone) and workspace.size == size


def test_blocks_may_be_nested_and_entered_again():
    outer, inner = fixpair.Threads(2), fixpair.Threads(3)
    from fixpair.threads import current
    with outer:
        first = current()
        with inner, inner:
            assert current() is not first
        assert current() is first
    assert current() is None
    with outer:
        assert current() is first


def test_an_observer_may_use_the_workspace_that_the_run_works_in(dtype):
    fft, x = fixpair.Fft(8, dtype), scattered(512, dtype)
    expected = fixpair.deposit(np.zeros((8, 8, 8), dtype), x, BOX)
    found = []
    with fixpair.Workspace():
        fixpair.evolve(x.copy(), np.zeros_like(x), fixpair.Gravity(BOX), fixpair.pm.linear_steps(2, 0.5, 0.6), fft,
                       observe=lambda _: found.append(fixpair.deposit(np.zeros((8, 8, 8), dtype), x, BOX)))
    assert len(found) == 2 and all(np.array_equal(each, expected) for each in found)


def test_threads_of_python_share_a_transform_and_a_pool(dtype):
    fft, pool, results = fixpair.Fft(16, dtype), fixpair.Threads(2), []
    field = fixpair.noise.white_modes(16, fixpair.Realisation(4), dtype=dtype)

    def run():
        with pool:
            for _ in range(5):
                data = fft.mesh()
                fft.modes(data)[...] = field
                results.append(fft.inverse(data).copy())
    running = [threading.Thread(target=run) for _ in range(3)]
    for each in running:
        each.start()
    for each in running:
        each.join()
    assert len(results) == 15 and all(np.array_equal(each, results[0]) for each in results)


def test_threads_are_asked_for_by_number():
    with pytest.raises(fixpair.RangeError):
        fixpair.Threads(5000)
