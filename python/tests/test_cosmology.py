"""Background, growth and spectra: the library's numbers, and numbers that anyone can check."""

import numpy as np
import pytest

import fixpair
from fixpair import Convention, Cosmology, Linear, Ratio, Species, cosmology

GOLIAT = Cosmology()
FIT = Linear(sigma8=0.8)


def test_einstein_and_de_sitter():
    universe, a = Cosmology(omega_m=1.0, omega_de=0.0), np.array([0.1, 0.5, 1.0])
    assert cosmology.expansion(a, universe) == pytest.approx(a**-1.5, rel=1e-14)
    growth = cosmology.growth_factors(a, universe)
    # The accuracy of the integration.
    assert growth.d == pytest.approx(a, rel=1e-7) and growth.f == pytest.approx(np.ones(3), rel=1e-7)
    assert growth.d2 == pytest.approx(-3 / 7 * a**2, rel=1e-7) and growth.d3a == pytest.approx(-a**3 / 3, rel=1e-7)


def test_the_library_has_the_same_bits(low):
    a, k = np.linspace(0.1, 1, 5), np.geomspace(1e-3, 1, 20)
    e, growth, power = np.empty(5), (fixpair.native.Growth * 5)(), np.empty(20)
    low.expansion(e, a, 5, GOLIAT)
    low.growth_factors(growth, a, 5, GOLIAT)
    low.linear_power(power, k, 20, GOLIAT, FIT, 1.0)
    assert np.array_equal(cosmology.expansion(a, GOLIAT), e)
    assert np.array_equal(cosmology.growth_factors(a, GOLIAT).f3c, [each.f3c for each in growth])
    assert np.array_equal(cosmology.linear_power(k, GOLIAT, FIT, 1.0), power)


def test_spectra_are_normalised_as_asked():
    k = np.geomspace(1e-4, 20, 400)
    power = cosmology.linear_power(k, GOLIAT, FIT)
    transfer = cosmology.linear_transfer(k, GOLIAT, FIT)
    for linear, sigma8 in ((FIT, 0.8), (Linear(k=k, power=power), 0.8), (Linear(k=k, power=power, sigma8=0.9), 0.9),
                           (Linear(k=k, transfer=transfer, sigma8=0.7), 0.7), (Linear(sigma8=0.8, smooth=True), 0.8)):
        # Rows are 3% apart in k; between them a cubic is good to 1e-6.
        assert cosmology.linear_sigma(8.0, GOLIAT, linear) == pytest.approx(sigma8, rel=1e-5)
    amplitude = Linear(k=k, transfer=transfer, amplitude=2.0)
    # T is 1 at the first row.
    expected = 2 * k**GOLIAT.n_s * (transfer / transfer[0])**2
    assert cosmology.linear_power(k, GOLIAT, amplitude) == pytest.approx(expected, rel=1e-12)


def test_power_grows_as_d_squared():
    d = cosmology.growth_factors(1 / 33, GOLIAT).d[0]
    early, late = (cosmology.linear_power(0.1, GOLIAT, FIT, z) for z in (32.0, 0.0))
    assert early == pytest.approx(late * d**2, rel=1e-12)


def test_alpha_is_the_poisson_equation():
    k, d = np.geomspace(1e-3, 1, 10), cosmology.growth_factors(0.5, GOLIAT).d[0]
    lss, cmb = (cosmology.alpha(k, GOLIAT, FIT, 1.0, convention) for convention in (Convention.LSS, Convention.CMB))
    expected = 2 / 3 * 2997.92458**2 * k**2 * cosmology.linear_transfer(k, GOLIAT, FIT) * d / GOLIAT.omega_m
    assert lss == pytest.approx(expected, rel=1e-9)
    # The number that the header names.
    assert cosmology.growth_suppression(GOLIAT) == pytest.approx(1.316, abs=5e-4)
    assert lss / cmb == pytest.approx(np.full(10, cosmology.growth_suppression(GOLIAT)), rel=1e-9)


def test_radiation_is_that_of_the_microwave_background():
    # Omega_gamma h^2 = 2.473e-5 at 2.7255 K, and 0.2271 of it for each neutrino.
    assert cosmology.radiation_density(2.7255, 3.046, 0.7) == pytest.approx(2.473e-5 * (1 + 0.2271 * 3.046) / 0.49, rel=1e-3)


def test_tables_hold_what_functions_say():
    n, box = 8, 100.0
    squares = np.arange(1.0, cosmology.mode_table_length(n))
    k = 2 * np.pi / box * np.sqrt(squares)
    alpha = cosmology.alpha_table(n, box, GOLIAT, FIT, 3.0)
    amplitude = cosmology.potential_amplitude_table(n, box, GOLIAT, FIT)
    assert alpha.size == amplitude.size == 49 and alpha[0] == amplitude[0] == 0
    assert alpha[1:] == pytest.approx(cosmology.alpha(k, GOLIAT, FIT, 3.0), rel=1e-9)
    expected = np.sqrt(cosmology.linear_power(k, GOLIAT, FIT) / box**3) / cosmology.alpha(k, GOLIAT, FIT)
    assert amplitude[1:] == pytest.approx(expected, rel=1e-9)


def test_species_are_ratios_of_their_columns():
    k = np.geomspace(1e-4, 10, 50)
    species = Species(k, np.ones(50), np.full(50, 0.9), np.full(50, 0.5))
    tables = [cosmology.species_table(species, ratio, 8, 100.0) for ratio in Ratio]
    assert [table[1] for table in tables] == pytest.approx([1.0, 0.9, 0.5], rel=1e-12)
    with pytest.raises(ValueError, match="elements"):
        Species(k, np.ones(49), np.ones(50), np.ones(50))


@pytest.mark.parametrize("wrong", [
    {}, {"k": [1.0, 2.0]}, {"power": [1.0, 2.0]}, {"sigma8": 0.8, "a_s": 2e-9}, {"k": [1.0, 2.0], "power": [1.0]},
    {"k": [1.0, 2.0], "power": [2.0, 1.0], "transfer": [1.0, 1.0]},
])
def test_spectra_that_say_too_little_or_too_much_are_refused(wrong):
    with pytest.raises(ValueError):
        Linear(**wrong)
