"""Runs fixpair's shared library beside Pylians3 and pySpectrum on the same particles and fields; for check_conventions.py --library PATH.

Each line of the table is an agreement that docs/comparing-spectra.md promises: what, whose, fixpair's function, and the largest difference
of all cases: windows, axes, precisions, triangles.
Integers (counts, edges, lists of triangles, cells of NGP) agree exactly. What Pylians and pySpectrum compute in float32 agrees to
FLOAT, whatever fixpair's precision; its twins _f32 and _f64 both run.
"""

import itertools
import math
import os
import tempfile

import MAS_library as MASL
import numpy as np
import Pk_library as PKL

from conventions import (
    BOX, N, SHELLS, STEP, TRIANGLES, Modes, import_pyspectrum, pylians_shells, pyspectrum_edge, quiet, second_field, skewed_field, worst)
from fixpair import ALIASED, CIC, NGP, PCS, TSC, WINDOW, Library

PRECISIONS = (np.float32, "f32"), (np.float64, "f64")
WINDOWS = {"NGP": NGP, "CIC": CIC, "TSC": TSC, "PCS": PCS}
# Transforms in float32 leave some 1e-7 of the field's root mean square in each mode, more than that of modes well below it; 1e-6 was seen.
FLOAT = 3e-6
# Means over up to 1e5 modes or separations of |n|, added one by one in f64 by Pylians: at most 1e5 ulps of 1e-16.
DOUBLE = 1e-11

rows = {}


def row(what, peer, fixpair, difference, limit, case=""):
    """Asserts, and keeps the worst of all cases for the table."""
    assert difference <= limit, f"{what}, {peer}, {fixpair} {case}: {difference:.1e} is above {limit:.0e}"
    worst_so_far = rows.get((what, peer, fixpair), (0.0, 0.0, 0))
    rows[what, peer, fixpair] = max(difference, worst_so_far[0]), max(limit, worst_so_far[1]), worst_so_far[2] + 1


def print_rows():
    print(f"\n{'what':<46} {'peer':<24} {'fixpair':<33} {'largest difference':<18} limit  cases")
    for (what, peer, fixpair), (difference, limit, cases) in rows.items():
        print(f"{what:<46} {peer:<24} {fixpair:<33} {difference:<18.1e} {f'{limit:.0e}' if limit else 'exact':<6} {cases}")


# ------------------------------------------------------------------------------------------------------------ deposits


def deposits(library):
    box = 1000.0
    position = np.random.default_rng(3).random((4 * N**3, 3), np.float32) * np.float32(box)
    position[position >= box] = 0.0
    # Pylians makes cells of positions in float32, right to 4e-6 of a cell here: nobody may stand so close to a face, where NGP jumps.
    cells = position.astype(np.float64) * N / box + 0.5
    position = position[(np.abs(cells - np.rint(cells)) > 1e-4).all(axis=1)]
    weight = np.random.default_rng(4).random(len(position), np.float32)
    for name, window in WINDOWS.items():
        for weights in None, weight:
            theirs = np.zeros((N, N, N), np.float32)
            quiet(MASL.MA, position, theirs, box, name, weights, verbose=False)
            for dtype, real in PRECISIONS:
                mesh = library.mesh(N, dtype)
                library.deposit(mesh, position.astype(dtype), box, window, None if weights is None else weights.astype(dtype))
                # NGP without weights counts. Else f32: a cell near 16 has an ulp of 1e-6, and tens of additions. f64: Pylians's positions
                # are off by 4e-6 of a cell, partly all one way (N/L in float32), in each of some 60 particles, at slopes up to 1.
                limit = 0.0 if name == "NGP" and weights is None else 2e-5 if real == "f32" else 3e-4
                label = "cells" if weights is None else "cells, weights"
                row(label, f"MAS_library.MA {name}", f"deposit_{real}", np.abs(mesh[:, :, :N] - theirs).max(), limit)
    # A particle half-way between two mesh points: both give it to the upper one.
    half = (np.indices((8, 8, 8)).reshape(3, -1).T + 0.5).astype(np.float32)
    theirs = np.zeros((8, 8, 8), np.float32)
    half[:, 1:] -= 0.5
    half = half[half[:, 0] % 2 == 0.5]
    MASL.MA(half, theirs, 8.0, "NGP", verbose=False)
    mesh = library.deposit(library.mesh(8, np.float32), half, 8.0, NGP)
    row("particles half-way between mesh points", "MAS_library.MA NGP", "deposit_f32", np.abs(mesh[:, :, :8] - theirs).max(), 0)


# --------------------------------------------------------------------------------------------------------------- power


def power(library):
    field = skewed_field(N)
    shells = math.isqrt(3 * (N // 2) ** 2)
    edges = library.edges_uniform(shells + 1, 1.0, 1.0)
    row("edges 1, 4, 9, ...", "floor(|n|)", "edges_uniform(1, 1)", max(abs(int(e) - (b + 1) ** 2) for b, e in enumerate(edges)), 0)
    for dtype, real in PRECISIONS:
        modes = library.modes(field, dtype)
        for axis, (name, window) in enumerate([("None", None), *WINDOWS.items()]):
            axis %= 3
            theirs = quiet(PKL.Pk, field, BOX, axis, name, 1, False)
            bins, ours = library.power([modes], edges, BOX, (0, 2, 4), axis, compensation=window and [WINDOW + window])
            ours, counts, mean = ours[0], bins["count"].astype(np.int64), bins["first"]
            oracle = Modes(field, window or 0)
            own = oracle.own_conjugates()
            extra = np.array([(own & oracle.shell(b * b, (b + 1) ** 2)).sum() for b in range(1, shells + 1)])
            plain = extra == 0
            assert len(theirs.k3D) == shells and extra.sum() == 7
            pylians, fixpair, case = "Pk", "power_sums, WINDOW or NULL", f"{real}, MAS {name}, axis {axis}"
            row("2 Nmodes3D less counts, corners less s", pylians, fixpair, np.abs(2 * theirs.Nmodes3D - extra - counts).max(), 0, case)
            row("mean k", pylians, fixpair, worst(theirs.k3D[plain], mean[plain] * 2 * np.pi / BOX), DOUBLE, case)
            row("P_0", pylians, fixpair, worst(theirs.Pk[plain, 0], ours[plain, 0]), FLOAT, case)
            for column, order in (1, 2), (2, 4):
                difference = np.abs(theirs.Pk[plain, column] - ours[plain, column]) / ours[plain, 0]
                row(f"P_{order}, of P_0", pylians, fixpair, difference.max(), FLOAT, case)
            corner = [BOX**3 * (np.abs(oracle.delta[own & oracle.shell(b * b, (b + 1) ** 2)]) ** 2).sum() for b in np.flatnonzero(~plain) + 1]
            weighted = (counts[~plain] * ours[~plain, 0] + corner) / (counts + extra)[~plain]
            row("P_0 of the three bins with corners, weighted", pylians, fixpair, worst(theirs.Pk[~plain, 0], weighted), FLOAT, case)
        other = second_field(N)
        cross = quiet(PKL.XPk, [field, other], BOX, 2, ["CIC", "TSC"], 1)
        _, ours = library.power([modes, library.modes(other, dtype)], edges, BOX, (0, 2, 4), 2, ((0, 0), (1, 1), (0, 1)),
                                [WINDOW + CIC, WINDOW + TSC])
        scale = np.sqrt(ours[0, :, 0] * ours[1, :, 0])[plain]
        for spectrum in 0, 1:
            row("P_0 of each", "XPk", "power_sums", worst(cross.Pk[plain, 0, spectrum], ours[spectrum, plain, 0]), FLOAT, real)
        for column, order in enumerate((0, 2, 4)):
            difference = np.abs(cross.XPk[plain, column, 0] - ours[2, plain, column]) / scale
            row(f"cross P_{order}, of sqrt(P_f P_g)", "XPk", "power_sums, pair 0, 1", difference.max(), FLOAT, real)


def correlation(library):
    field = skewed_field(N)
    theirs = quiet(PKL.Xi, field, BOX, "CIC", 0, 1)
    edges = library.edges_uniform(len(theirs.r3D) + 1, 1.0, 1.0)
    for dtype, real in PRECISIONS:
        xi = library.correlation(library.modes(field, dtype), WINDOW + CIC)
        bins, ours = library.correlation_multipoles(xi, edges, (0, 2, 4), 0)
        row("separations", "Xi.Nmodes3D", "correlation_sums", np.abs(theirs.Nmodes3D - bins["count"]).max(), 0, real)
        row("mean separation", "Xi.r3D", "correlation_sums", worst(theirs.r3D, bins["first"] * BOX / N), DOUBLE, real)
        # xi crosses 0; the float32 transform leaves some 1e-7 of the variance, xi(0) = sum of |delta_k|^2, in each cell.
        for column, order in enumerate((0, 2, 4)):
            difference = np.abs(theirs.xi[:, column] - ours[0, :, column]) / xi[0, 0, 0]
            row(f"xi_{order}, of xi(0)", "Xi.xi", "correlation_modes, _sums", difference.max(), FLOAT, real)


def particles(library):
    """From particles to P of each, and the flat noise of ALIASED that Pylians has not."""
    number, box = 4 * N**3, BOX
    position = np.random.default_rng(7).random((number, 3), np.float32) * np.float32(box)
    position[position >= box] = 0.0
    edges = library.edges_uniform(N // 2, 1.0, 1.0)
    mesh = np.zeros((N, N, N), np.float32)
    MASL.MA(position, mesh, box, "CIC", verbose=False)
    theirs = quiet(PKL.Pk, mesh / np.float32(number / N**3) - np.float32(1), box, 2, "CIC", 1, False)
    modes = library.deposit(library.mesh(N, np.float32), position, box, CIC)
    modes[:, :, :N] *= np.float32(N**3 / number)
    modes[:, :, :N] -= np.float32(1)
    library.forward(modes)
    _, ours = library.power([modes], edges, box, compensation=[WINDOW + CIC])
    row("P_0 of Poisson particles", "MA and Pk, CIC", "deposit_f32, WINDOW + CIC", worst(theirs.Pk[: N // 2 - 1, 0], ours[0, :, 0]), 1e-5)
    bins, ours = library.power([modes], edges, box, compensation=[ALIASED + CIC])
    noise = library.shot_noise(None, number, box)
    # Exponential deviates: the mean of count/2 of them scatters by sqrt(2/count).
    scatter = np.abs(ours[0, :, 0] / noise - 1) * np.sqrt(bins["count"] / 2)
    row("their noise is flat: |P n - 1| in sigma", "", "deposit_f32, ALIASED + CIC", scatter.max(), 4.0)
    left = library.subtract_shot_noise(ours.copy(), bins, noise)
    row("subtracted noise, of V/N", "V/N", "subtract_shot_noise", np.abs((ours - left) / (box**3 / number) - 1).max(), 1e-12)


# ---------------------------------------------------------------------------------------------------------- bispectrum


def pylians_bispectrum(library):
    field, fundamental = skewed_field(N), 2.0 * np.pi / BOX
    for n1, n2, turn in TRIANGLES:
        theirs = quiet(PKL.Bk, field, BOX, n1 * fundamental, n2 * fundamental, np.array([turn * np.pi]), "CIC", 1)
        ends = pylians_shells(theirs.k)
        edges = sorted({edge for pair in ends for edge in pair})
        runs = [[s for s, edge in enumerate(edges[:-1]) if low <= edge < high] for low, high in ends]
        triangles = np.array([*itertools.product(*runs)], np.uint32)
        counts = library.triangle_counts(triangles, edges, N)
        count = counts.sum()
        case = f"of ({n1}, {n2}, {theirs.k[2] / fundamental:.2f}) k_f"
        row("N_triangles", "Bk.triangles N^6", "triangle_counts", abs(np.rint(theirs.triangles[0] * float(N) ** 6) - count), 0, case)
        for dtype, real in PRECISIONS:
            modes = library.modes(field, dtype)
            library.compensate(modes, WINDOW + CIC)
            sums = library.bispectrum_sums(modes, triangles, edges)
            total = library.bispectrum(sums.sum(axis=0)[None, :], [count], N, BOX)
            parts = library.bispectrum(sums, counts, N, BOX)
            # k = 0 counts, adds nothing, and leaves few triples here: more cancellation than in the others.
            limit = 2e-5 if n1 == 1 else FLOAT
            inside = " with k = 0" if n1 == 1 else ""
            row("B" + inside, "Bk.B", "bispectrum, sums added", abs(theirs.B[0] / total[0] - 1), limit, case)
            row("B" + inside, "Bk.B", "bispectrum, B weighted by counts", abs(theirs.B[0] / (parts @ counts / count) - 1), limit, case)
            bins, values = library.power([modes], edges, BOX)
            weighted, weights = values[0, :, 0] * bins["count"], bins["count"]
            spectra = [weighted[run].sum() / weights[run].sum() for run in runs]
            row("P of its three shells", "Bk.Pk", "power_sums, runs of bins", worst(theirs.Pk, spectra), FLOAT, case)
            reduced = library.reduced(total, [[0, 1, 2]], spectra)
            row("Q" + inside, "Bk.Q", "bispectrum_reduced", abs(theirs.Q[0] / reduced[0] - 1), limit, case)


def pyspectrum_bispectrum(library, pyspectrum):
    folder = pyspectrum.dat_dir()
    field = skewed_field(N)
    with tempfile.TemporaryDirectory() as own:
        pyspectrum.dat_dir = lambda: own  # it saves its counts: not among its own files
        theirs = quiet(pyspectrum._Bk_periodic, Modes(field).delta.astype(np.complex64), Nmax=SHELLS, Ncut=STEP, step=STEP)
    edges = library.edges_uniform(SHELLS + 1, STEP / 2.0, STEP)
    expected = [pyspectrum_edge(i, STEP) for i in range(1, SHELLS + 2)]
    row("edges 3, 21, 57, ...", "floor(|n|/3 + 1/2)", "edges_uniform(1.5, 3)", max(abs(int(a) - b) for a, b in zip(edges, expected)), 0)
    triangles = library.closed_triangles(edges, np.arange(1, SHELLS + 1) * float(STEP))
    listed = np.stack([theirs[f"i_k{a}"] for a in (3, 2, 1)], 1) // STEP - 1  # read backwards
    order = np.lexsort(listed.T[::-1])
    same = len(listed) == len(triangles) and np.array_equal(listed[order], triangles)
    row(f"list of {len(triangles)} triangles, read backwards", "_Bk_periodic", "closed_triangles, centres", float(not same), 0)
    counts = library.triangle_counts(triangles, edges, N)
    orders = np.array([6 // len(set(itertools.permutations(t))) for t in triangles.tolist()])
    row("counts times orders", "counts", "triangle_counts", np.abs(np.rint(theirs["counts"][order] * orders) - counts).max(), 0)
    for dtype, real in PRECISIONS:
        modes = library.modes(field, dtype)
        ours = library.bispectrum(library.bispectrum_sums(modes, triangles, edges), counts, N, BOX)
        row("B before shot noise", "b123 V^2", "bispectrum", worst(theirs["b123"][order] * BOX**6, ours), FLOAT, real)
        _, spectra = library.power([modes], edges, BOX)
        spectra = spectra[0, :, 0]
        for a in (1, 2, 3):
            power_of_shell = spectra[triangles[:, 3 - a]]
            row("P of its shells", "p0k1, p0k2, p0k3, V", "power_sums", worst(theirs[f"p0k{a}"][order] * BOX**3, power_of_shell), FLOAT, real)
    # Its shot noise: (P1 + P2 + P3)/nbar + 1/nbar^2, P free of noise.
    number = 1e5
    clean = spectra - BOX**3 / number
    formula = clean[triangles].sum(axis=1) * BOX**3 / number + (BOX**3 / number) ** 2
    noise = library.bispectrum_shot_noise(triangles, clean, library.shot_noise(None, int(number), BOX))
    row("shot noise of B", "formula of b123_sn", "bispectrum_shot_noise", worst(formula, noise), 1e-12)
    if not os.path.isfile(os.path.join(folder, "counts.Ngrid360.Nmax40.Ncut3.step3.pyfftw")):
        print("pySpectrum: no file of counts for 360^3 found; left out")
        return
    pyspectrum.dat_dir = lambda: folder
    theirs = quiet(pyspectrum._counts_Bk123, Ngrid=360, Nmax=40, Ncut=3, step=3) / 360.0**3
    edges = library.edges_uniform(41, 1.5, 3.0)
    triangles = library.closed_triangles(edges, np.arange(1.0, 41.0))
    counts = library.triangle_counts(triangles, edges, 360)
    theirs = np.array([theirs[k, j, i] for i, j, k in triangles.tolist()])
    row(f"counts of {len(triangles)} triangles, 360^3", "its file of counts", "triangle_counts", np.abs(np.rint(theirs) - counts).max(), 0)


def run(path):
    library = Library(path)
    deposits(library)
    power(library)
    correlation(library)
    particles(library)
    pylians_bispectrum(library)
    pyspectrum = import_pyspectrum()
    if pyspectrum is not None:
        pyspectrum_bispectrum(library, pyspectrum)
    print_rows()
