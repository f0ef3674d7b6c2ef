"""What fixing, pairing and matching gain in the universes of a demonstration: numbers, and the table of them."""

from dataclasses import dataclass

import numpy as np

from .. import cosmology, variance
from ..native import Amplitude, Phase
from ..variance import Ensemble
from .universes import END, F_NL, Kind, Laboratory, Measured

TYPES = {
    "Normal": (Amplitude.NORMAL, False), "Normal-Paired": (Amplitude.NORMAL, True),
    "Fixed": (Amplitude.FIXED, False), "Fixed-Paired": (Amplitude.FIXED, True),
}


@dataclass
class Result:
    """One type of simulation."""

    simulations: int
    """That one estimate costs."""
    scatter: np.ndarray
    """Of matter at z = 1, per simulation, over that of a Gaussian field."""
    response: np.ndarray
    """P_tm(f_NL = 100)/P_tm(0) of matched universes, its mean, and below its standard error."""
    unmatched: np.ndarray
    """The same of universes of different seeds."""
    f_nl: dict[float, np.ndarray]
    """Estimates of f_NL, one a seed or pair."""
    difference: np.ndarray
    """Of matched estimates."""


def estimates(measured: dict[Kind, list[Measured]], name: str, f_nl: float, member: str) -> np.ndarray:
    """What a type of simulations measures, one row a seed; of pairs the average."""
    amplitude, paired = TYPES[name]
    one, other = (np.array([getattr(each, member) for each in measured[Kind(amplitude, phase, f_nl)]]) for phase in Phase)
    return variance.pair_average(one, other) if paired else one


def response(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Mean ratio of two lists of spectra, seed by seed, and its standard error."""
    ensemble = Ensemble(above.shape[1])
    ensemble.add(above / below)
    return np.array([ensemble.mean(), ensemble.error_of_mean()])


def tell(laboratory: Laboratory, measured: dict[Kind, list[Measured]]) -> dict[str, Result]:
    """The results of all four types."""
    results = {}
    for name, (_, paired) in TYPES.items():
        cost = 2 if paired else 1
        matter, ensemble = estimates(measured, name, 0.0, "matter"), Ensemble(laboratory.k.size)
        ensemble.add(matter)
        scatter, _ = variance.sigma_per_simulation(ensemble.deviation(), len(ensemble), cost)
        gaussian = variance.sigma_gaussian(ensemble.mean(), laboratory.modes)
        cross = [estimates(measured, name, f_nl, "cross") for f_nl in F_NL]
        f_nl = {f_nl: estimates(measured, name, f_nl, "f_nl") for f_nl in F_NL}
        results[name] = Result(cost, scatter / gaussian, response(cross[1], cross[0]), response(np.roll(cross[1], 1, 0), cross[0]),
                               f_nl, f_nl[100.0] - f_nl[0.0])
    return results


def tracers(laboratory: Laboratory, measured: dict[Kind, list[Measured]], result: Result) -> tuple[float, float, float]:
    """Bias b_g of the tracers, b_phi of b(k) = b_g + b_phi f_NL/alpha, and its error.

    From the matched response of Fixed pairs in the first three shells, whose waves are longer than those that make the tracers:
    P_tm(100)/P_tm(0) - 1 = 100 b_phi/(alpha b_g).
    """
    near = slice(3)
    cross, matter = (estimates(measured, "Fixed-Paired", 0.0, member).mean(0) for member in ("cross", "matter"))
    b_g = float((cross / matter)[near].mean())
    alpha = cosmology.alpha(laboratory.k, laboratory.conditions.cosmology, laboratory.linear, 1 / END - 1)
    x, (y, error) = (100 / (alpha * b_g))[near], result.response[:, near]
    weight = (x / error)**2
    return b_g, float((weight * (y - 1) / x).sum() / weight.sum()), float(weight.sum()**-0.5)


def table(laboratory: Laboratory, results: dict[str, Result]) -> str:
    """The numbers, a type a row."""
    k = laboratory.k
    limits = [limit for limit in (0.03, 0.06, 0.1) if (k < limit).any()]
    reference = results["Normal"].f_nl[100.0].std(ddof=1)
    head = "".join(f"{f'k < {limit:g}':>10}" for limit in limits)
    lines = [f"{'':15}scatter of P at z = 1 over Gaussian      f_NL of the potential, true value 100",
             f"{'':15}{head}{'':10}   each field        V_eff/V     matched f100 - f0   V_eff/V"]
    for name, result in results.items():
        scatters = "".join(f"{np.sqrt((result.scatter[k < limit]**2).mean()):10.3f}" for limit in limits)
        values, difference = result.f_nl[100.0], result.difference
        volumes = [variance.effective_volume(reference, sigma, simulations=result.simulations)
                   for sigma in (values.std(ddof=1), difference.std(ddof=1))]
        lines.append(f"{name:15}{scatters}{'':8}{values.mean():7.1f} +/- {values.std(ddof=1):6.2f}{volumes[0]:10.3g}"
                     f"{difference.mean():12.1f} +/- {difference.std(ddof=1):6.2f}{volumes[1]:10.3g}")
    return "\n".join(lines)
