"""One seed is one universe."""

import numpy as np
import pytest

import fixpair
from fixpair import Amplitude, Brick, Nyquist, Phase, Realisation, Scheme, Space, noise
from samples import SEED, numbers


def bits(low, real, brick, realisation, table=None):
    memory = np.zeros(brick.reals, np.float32 if real == "f32" else np.float64)
    getattr(low, f"white_modes_{real}")(memory, memory.size, brick, realisation, table, 0 if table is None else table.size, None)
    return brick.view(memory)


@pytest.mark.parametrize("scheme", Scheme)
def test_modes_have_the_bits_of_the_library(low, dtype, scheme):
    realisation = Realisation(SEED, scheme=scheme, amplitude=Amplitude.FIXED)
    real, table = ("f32", "f64")[dtype.itemsize // 8], np.linspace(0.5, 2.0, 3 * 6**2 + 1)
    for brick in (Brick.whole(12, Space.FOURIER), Brick.transposed_slab(12, 3, 4), Brick.slab(12, 1, 5, Space.FOURIER)):
        expected = bits(low, real, brick, realisation, table)
        assert np.array_equal(noise.white_modes(brick, realisation, dtype=dtype, amplitude=table), expected)
    assert np.array_equal(noise.white_modes(12, realisation, dtype=dtype), bits(low, real, Brick.whole(12, Space.FOURIER), realisation))


def test_fixed_modes_have_modulus_one_and_the_phases_of_normal_ones():
    normal, fixed = (noise.white_modes(12, Realisation(SEED, amplitude=amplitude)) for amplitude in (Amplitude.NORMAL, Amplitude.FIXED))
    drawn = fixed != 0
    assert np.abs(np.abs(fixed[drawn]) - 1).max() < 4e-16
    assert np.abs(np.angle(normal[drawn] * np.conj(fixed[drawn]))).max() < 1e-15


def test_inverted_is_bitwise_negation(dtype):
    one, other = (noise.white_modes(12, Realisation(SEED, phase=phase), dtype=dtype) for phase in Phase)
    assert np.array_equal(one, -other)


def test_single_precision_is_rounded_double_precision():
    one, other = (noise.white_modes(12, Realisation(SEED), dtype=dtype) for dtype in (np.float32, np.float64))
    assert np.array_equal(one, other.astype(np.complex64))


def test_a_coarse_mesh_shares_modes_with_a_fine_one():
    coarse, fine = noise.white_modes(8, Realisation(SEED)), noise.white_modes(16, Realisation(SEED))
    assert np.array_equal(coarse[1:4, 1:4, :4], fine[1:4, 1:4, :4])


def test_own_modes_and_own_noise_are_fixed(dtype):
    realisation = Realisation(1, amplitude=Amplitude.FIXED)
    modes = noise.white_modes(12, Realisation(SEED), dtype=dtype)
    assert noise.impose(modes, realisation) is modes
    # Fixed from the rounded modes: a rounding away from what fixes before it rounds.
    assert np.abs(np.abs(modes[modes != 0]) - 1).max() < 4 * np.finfo(dtype).eps
    fft = fixpair.Fft(12, dtype)
    data = fft.mesh()
    fft.cells(data)[...] = numbers(12**3).reshape(12, 12, 12)
    modes = noise.modes_from_field(data, fft, realisation)
    assert np.shares_memory(modes, data) and np.abs(np.abs(modes[modes != 0]) - 1).max() < 4 * np.finfo(dtype).eps


def test_the_generators_are_the_published_ones():
    # Known answers of Random123.
    assert noise.philox4x32_10([0] * 4, [0] * 2).tolist() == [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]
    assert noise.philox4x32_10([2**32 - 1] * 4, [2**32 - 1] * 2).tolist() == [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]
    uniforms = noise.ranlxd1(10, 1)
    assert ((uniforms >= 0) & (uniforms < 1)).all() and (uniforms * 2.0**48 == np.floor(uniforms * 2.0**48)).all()
    seeds = noise.ngenic_seeds(8, 7)
    assert seeds.shape == (8, 8) and np.array_equal(noise.ngenic_seeds(Brick.slab(8, 2, 3, Space.FOURIER), 7), seeds[2:5])


def test_nyquist_modes_are_zero_unless_asked_for():
    zero, filled = (noise.white_modes(8, Realisation(SEED, nyquist=nyquist)) for nyquist in Nyquist)
    assert not zero[4].any() and not zero[:, :, 4].any() and filled[4].any()
