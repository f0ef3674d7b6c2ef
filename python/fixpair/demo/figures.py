"""The two figures of the demonstration."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from .. import cosmology  # noqa: E402
from ..native import Amplitude, Phase  # noqa: E402
from .story import Result  # noqa: E402
from .universes import END, Kind, Laboratory, Measured  # noqa: E402

# Okabe & Ito 2008: told apart by all eyes, and by lightness too.
COLOURS = {"Normal": "#56B4E9", "Normal-Paired": "#0072B2", "Fixed": "#E69F00", "Fixed-Paired": "#D55E00"}
STYLE: Any = {
    "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.linewidth": 0.7, "lines.linewidth": 1.4, "lines.markersize": 4, "legend.frameon": False, "figure.dpi": 110,
    "savefig.dpi": 160, "figure.constrained_layout.use": True,
}
K = r"$k\;[h\,\mathrm{Mpc}^{-1}]$"


def draw(folder: Path, laboratory: Laboratory, measured: dict[Kind, list[Measured]], results: dict[str, Result],
         tracers: tuple[float, float, float]) -> list[Path]:
    """Writes the figures; returns where."""
    files = [folder / "power.png", folder / "f_nl.png"]
    with plt.rc_context(STYLE):
        for file, panels in zip(files, ((_initial_power, _scatter), (_response, _estimates))):
            figure, axes = plt.subplots(1, 2, figsize=(8.2, 3.4))
            for axis, panel in zip(axes, panels):
                panel(axis, laboratory, measured, results, tracers)
            figure.savefig(file)
            plt.close(figure)
    return files


def _wavenumbers(axis, laboratory):
    axis.set_xlabel(K)
    axis.set_xlim(0, laboratory.k[-1] * 1.04)


def _initial_power(axis, laboratory, measured, results, tracers):
    one, other = ([each.linear for each in measured[Kind(amplitude, Phase.ORIGINAL, 0.0)]] for amplitude in
                  (Amplitude.NORMAL, Amplitude.FIXED))
    ratios = np.array(one) / np.array(other)
    expected = np.sqrt(2 / laboratory.modes)
    axis.fill_between(laboratory.k, 1 - expected, 1 + expected, color="0.92", lw=0)
    for ratio in ratios:
        axis.plot(laboratory.k, ratio, color=COLOURS["Normal"], lw=0.7, alpha=0.7)
    axis.plot([], [], color=COLOURS["Normal"], lw=0.9, label="Normal, each seed")
    axis.plot(laboratory.k, np.ones_like(laboratory.k), color=COLOURS["Fixed"], lw=2, label="Fixed, every seed")
    axis.fill_between([], [], [], color="0.92", label=r"$\pm\sqrt{2/N_k}$")
    axis.set(title="Initial conditions: power over the input", ylabel=r"$P(k)/P_\mathrm{input}(k)$", ylim=(0.5, 1.7))
    axis.legend(loc="upper right")
    _wavenumbers(axis, laboratory)


def _scatter(axis, laboratory, measured, results, tracers):
    for name, result in results.items():
        axis.plot(laboratory.k, result.scatter, "o-", color=COLOURS[name], label=name)
    axis.axhline(1, color="0.5", lw=0.8, ls="--", label="Gaussian field")
    axis.set_yscale("log")
    axis.set(title="Matter at z = 1: scatter per simulation", ylabel=r"$\sigma_P\,/\,\sqrt{2/N_k}\,P$")
    axis.set_ylim(top=4)
    axis.legend(loc="lower right")
    _wavenumbers(axis, laboratory)


def _response(axis, laboratory, measured, results, tracers):
    b_g, b_phi, _ = tracers
    alpha = cosmology.alpha(laboratory.k, laboratory.conditions.cosmology, laboratory.linear, 1 / END - 1)
    axis.plot(laboratory.k, 1 + b_phi * 100 / (alpha * b_g), color="0.3", lw=1, label=r"$1 + b_\phi f_\mathrm{NL}/(b_g\,\alpha)$")
    result = results["Fixed-Paired"]
    for values, label, colour, shift in ((results["Normal"].unmatched, "Normal, other seeds", COLOURS["Normal"], 0.0008),
                                         (result.response, "Fixed-Paired, Matched", COLOURS["Fixed-Paired"], 0.0)):
        axis.errorbar(laboratory.k + shift, values[0], values[1], fmt="o", ms=3.5, lw=1, color=colour, label=label)
    high = max(1.1, 1.25 * (result.response[0].max() - 1) + 1)
    axis.set_ylim(2 - high, high)
    axis.set(title="Tracers at z = 1: what f$_\\mathrm{NL}$ = 100 adds", ylabel=r"$P_\mathrm{tm}(100)\,/\,P_\mathrm{tm}(0)$")
    axis.legend(loc="lower right")
    _wavenumbers(axis, laboratory)


def _estimates(axis, laboratory, measured, results, tracers):
    for place, (name, result) in enumerate(results.items()):
        for low, high in zip(result.f_nl[0.0], result.f_nl[100.0]):
            axis.plot([place - 0.22, place + 0.22], [low, high], "o-", color=COLOURS[name], lw=0.8, ms=3)
    for true in (0, 100):
        axis.axhline(true, color="0.6", lw=0.7, ls="--", zorder=0)
    axis.set(title="f$_\\mathrm{NL}$ of each field, matched ones joined", ylabel=r"$f_\mathrm{NL}$ measured: 0 (left) and 100 (right)")
    axis.set_xticks(range(len(results)), [name.replace("-", "-\n") for name in results])
