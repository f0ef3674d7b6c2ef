"""Runs Pylians3 and pySpectrum beside fixpair on the same fields, and asserts what docs/comparing-spectra.md says.

    python check_conventions.py [--library PATH]

Compares both with fixpair's conventions written out in numpy (conventions.py); with --library also with the shared library
(check_library.py), which `cargo rustc --release --lib --crate-type cdylib` makes: target/release/libfixpair.so. Needs
Pylians; what concerns pySpectrum is left out, with a line that says so, where it cannot be imported. Each printed line is a
claim of the page with the number measured. A failed claim raises.
"""

import argparse
import itertools
import math
import os
import tempfile

import MAS_library as MASL
import numpy as np
import Pk_library as PKL

from conventions import (
    BOX, N, SHELLS, STEP, TRIANGLES, Modes, import_pyspectrum, pylians_shells, pyspectrum_edge, quiet, second_field, skewed_field, worst)


def claim(text, measured, limit):
    print(f"{text}: {measured:.1e} (limit {limit:.0e})")
    assert measured <= limit, text


# ------------------------------------------------------------------------------------------------------------ Pylians


def pylians_power():
    field = skewed_field(N)
    for name, window, axis in ("None", 0, 2), ("CIC", 2, 0), ("PCS", 4, 1):
        modes = Modes(field, window)
        theirs = PKL.Pk(field, BOX, axis, name, 1, False)
        counts, ratio, k, multipoles = 0, 0.0, 0.0, 0.0
        for b in range(1, len(theirs.k3D) + 1):
            shell = modes.shell(b * b, (b + 1) * (b + 1))
            number, mean_n, p = modes.power(shell, BOX**3, axis)
            if b < N // 2:
                counts = max(counts, abs(number - 2 * theirs.Nmodes3D[b - 1]))
                ratio = max(ratio, abs(theirs.Pk[b - 1, 0] / p[0] - 1.0))
                k = max(k, abs(theirs.k3D[b - 1] / (mean_n * 2 * np.pi / BOX) - 1.0))
                multipoles = max(multipoles, *(abs(theirs.Pk[b - 1, l] - p[l]) / p[0] for l in (1, 2)))
            else:
                # n = -n modulo N: all components 0 or N/2. Pylians gives such a mode the weight of a pair.
                own = shell & modes.own_conjugates()
                weighted = number * p[0] + BOX**3 * (np.abs(modes.delta[own]) ** 2).sum()
                ratio = max(ratio, abs(theirs.Pk[b - 1, 0] * (number + own.sum()) / weighted - 1.0))
                counts = max(counts, abs(number + own.sum() - 2 * theirs.Nmodes3D[b - 1]))
        claim(f"Pylians P(k), MAS {name}: |counts - 2 Nmodes| (corner shells: own conjugates twice)", counts, 0)
        claim(f"Pylians P(k), MAS {name}: P_0 over fixpair's, less 1", ratio, 1e-5)
        claim(f"Pylians P(k), MAS {name}: mean k over fixpair's, less 1", k, 1e-12)
        claim(f"Pylians P(k), MAS {name}: P_2 and P_4 less fixpair's, over P_0", multipoles, 1e-5)
    mixed = second_field(N)
    modes, other = Modes(field, 2), Modes(mixed, 3)
    cross = quiet(PKL.XPk, [field, mixed], BOX, 2, ["CIC", "TSC"], 1)
    difference = 0.0
    for b in range(1, N // 2):
        shell = modes.shell(b * b, (b + 1) * (b + 1))
        product = BOX**3 * (modes.delta[shell] * other.delta[shell].conj()).real.mean()
        scale = BOX**3 * np.sqrt((np.abs(modes.delta[shell]) ** 2).mean() * (np.abs(other.delta[shell]) ** 2).mean())
        difference = max(difference, abs(cross.XPk[b - 1, 0, 0] - product) / scale)
    claim("Pylians XPk: cross power less V <f g*>, over sqrt(P_f P_g)", difference, 1e-5)
    for b in range(N // 2, len(theirs.k3D) + 1):
        number, _, p = Modes(field, 4).power(modes.shell(b * b, (b + 1) ** 2), BOX**3)
        if number != 2 * theirs.Nmodes3D[b - 1]:
            ratio = theirs.Pk[b - 1, 0] / p[0]
            print(f"    shell {b}: {number} modes, Pylians 2 x {int(theirs.Nmodes3D[b - 1])}, its P_0 over fixpair's {ratio:.5f}")
    small = PKL.Pk(field[:16, :16, :16].copy(), BOX, 2, "None", 1, False)
    print("Pylians Nmodes3D of a 16^3 mesh:", *small.Nmodes3D[:7].astype(int))
    assert [*small.Nmodes3D[:6]] == [13, 33, 79, 117, 205, 235]
    same = np.array_equal(PKL.Pk(field, BOX, 2, "cic", 1, False).Pk, PKL.Pk(field, BOX, 2, "None", 1, False).Pk)
    print("Pylians takes MAS 'cic' for no compensation, in silence:", same)
    assert same
    try:
        PKL.Pk(field.astype(np.float64), BOX, 2, "CIC", 1, False)
        raise AssertionError("Pylians took a float64 mesh")
    except ValueError as error:
        print("Pylians refuses a float64 mesh:", error)


def pylians_shot_noise():
    particles = 4 * N**3
    position = np.random.default_rng(7).random((particles, 3), np.float32) * np.float32(BOX)
    position[position >= BOX] = 0.0
    mesh = np.zeros((N, N, N), np.float32)
    MASL.MA(position, mesh, BOX, "CIC")
    delta = mesh * np.float32(N**3 / particles) - np.float32(1.0)
    theirs = PKL.Pk(delta, BOX, 2, "CIC", 1, False)
    modes = Modes(delta, 2)
    c1 = math.prod(1.0 - 2.0 / 3.0 * np.sin(np.pi * a / N) ** 2 for a in modes.n)
    excess = c1 / math.prod(np.sinc(a / N) ** 4 for a in modes.n)
    for b in 4, N // 4, N // 2 - 1:
        expected = excess[modes.shell(b * b, (b + 1) ** 2)].mean()
        measured = theirs.Pk[b - 1, 0] * particles / BOX**3
        # Poisson scatter of the mean of Nmodes exponential deviates.
        scatter = expected / math.sqrt(theirs.Nmodes3D[b - 1])
        print(f"Poisson particles, CIC, shell {b}: Pylians P n = {measured:.4f}, <C1 / sinc^4> = {expected:.4f}")
        assert abs(measured - expected) < 4.0 * scatter


def pylians_deposit():
    for window, weights in ("NGP", {0: 1.0}), ("CIC", {0: 0.7, 1: 0.3}):
        mesh = np.zeros((8, 8, 8), np.float32)
        MASL.MA(np.array([[0.3, 1.0, 1.0]], np.float32), mesh, 8.0, window)
        assert all(abs(mesh[i, 1, 1] - weights.get(i, 0.0)) < 1e-6 for i in range(8))
    print("Pylians: node i of the mesh is at x = i L / N (NGP and CIC of a particle at 0.3 cells)")
    mesh = np.zeros((8, 8, 8), np.float32)
    MASL.MA(np.array([[-0.3, 1.0, 1.0]], np.float32), mesh, 8.0, "CIC")
    print(f"Pylians CIC of a particle at -0.3 cells: node 0 gets {mesh[0, 1, 1]:.2f}, node 1 gets {mesh[1, 1, 1]:.2f}")
    assert mesh[0, 1, 1] > 1.29 and mesh[1, 1, 1] < -0.29


def pylians_bispectrum():
    field = skewed_field(N)
    modes = Modes(field, 2)
    fundamental = 2.0 * np.pi / BOX
    for n1, n2, turn in TRIANGLES:
        angle = np.array([turn * np.pi])
        theirs = quiet(PKL.Bk, field, BOX, n1 * fundamental, n2 * fundamental, angle, "CIC", 1)
        edges = pylians_shells(theirs.k)
        shells = [modes.shell(*e) for e in edges]
        count, total = modes.triples(*shells)
        triangles = theirs.triangles[0] * float(N) ** 6
        power = [modes.power(s, BOX**3)[2][0] for s in shells]
        print(f"Pylians B({n1}, {n2}, {theirs.k[2] / fundamental:.3f} k_f): |n|^2 in {edges}, triangles * N^6 = {triangles:.1f}")
        claim("    its triangles * N^6 over fixpair's count, less 1", abs(triangles / count - 1.0), 1e-5)
        claim(f"    its B over fixpair's (count {count}), less 1", abs(theirs.B[0] * count / (BOX**6 * total) - 1.0), 1e-5)
        claim("    its three P over fixpair's, less 1", worst(theirs.Pk, power), 1e-5)
        products = power[0] * power[1] + power[0] * power[2] + power[1] * power[2]
        claim("    its Q over fixpair's, less 1", abs(theirs.Q[0] * count * products / (BOX**6 * total) - 1.0), 1e-5)
        # The shells overlap. Shells that do not, cut at all six edges, give the same numbers as sums over their triples.
        cuts = sorted({e for pair in edges for e in pair})
        fine = list(zip(cuts, cuts[1:]))
        inside = [[f for f in fine if low <= f[0] and f[1] <= high] for low, high in edges]
        parts = [modes.triples(*(modes.shell(*f) for f in triple)) for triple in itertools.product(*inside)]
        assert sum(p[0] for p in parts) == count
        ratio = theirs.B[0] * count / (BOX**6 * sum(p[1] for p in parts))
        claim(f"    its B over that of {len(parts)} triples of {len(fine)} disjoint shells, less 1", abs(ratio - 1.0), 1e-5)


# --------------------------------------------------------------------------------------------------------- pySpectrum


def pyspectrum_bispectrum(pyspectrum):
    step, shells = STEP, SHELLS  # three upper edges: 3 * 6.5 * 3 = 58.5 < N
    field = skewed_field(N)
    modes = Modes(field)
    with tempfile.TemporaryDirectory() as folder:
        pyspectrum.dat_dir = lambda: folder  # it saves its counts: not among its own files
        theirs = pyspectrum._Bk_periodic(modes.delta.astype(np.complex64), Nmax=shells, Ncut=step, step=step)
    closed = [(i, j, l) for i in range(1, shells + 1) for j in range(1, i + 1) for l in range(max(i - j, 1), j + 1)]
    assert closed == [tuple(t) for t in np.stack([theirs[f"i_k{a}"] for a in (1, 2, 3)], 1) // step]
    edges = [pyspectrum_edge(i, step) for i in range(1, shells + 2)]
    print("pySpectrum, shells of 3 k_f: edges of |n|^2", edges)
    masks = [modes.shell(a, b) for a, b in zip(edges, edges[1:])]
    print("modes of its shells 1, 2, 3:", *(int(m.sum()) for m in masks[:3]))
    counts, bispectrum, power = 0.0, 0.0, 0.0
    for t, (i, j, l) in enumerate(closed):
        number, total = modes.triples(masks[i - 1], masks[j - 1], masks[l - 1])
        orders = 6 // len(set(itertools.permutations((i, j, l))))
        counts = max(counts, abs(theirs["counts"][t] * orders / number - 1.0))
        bispectrum = max(bispectrum, abs(theirs["b123"][t] * number / total - 1.0))
        power = max(power, abs(theirs["p0k1"][t] * BOX**3 / modes.power(masks[i - 1], BOX**3)[2][0] - 1.0))
    claim(f"pySpectrum, {len(closed)} triangles: counts * orders over fixpair's ordered counts, less 1", counts, 1e-5)
    claim("pySpectrum: b123 * V^2 (before shot noise) over fixpair's B, less 1", bispectrum, 1e-4)
    claim("pySpectrum: p0k * V (before shot noise) over fixpair's P, less 1", power, 1e-5)
    print("closed triples that neither list holds, such as shells (3, 1, 1):", modes.triples(masks[2], masks[0], masks[0])[0])


def pyspectrum_counts(pyspectrum, folder):
    """The file of counts that pySpectrum ships for 40 shells of 3 k_f on 360^3."""
    if not os.path.isfile(os.path.join(folder, "counts.Ngrid360.Nmax40.Ncut3.step3.pyfftw")):
        print("pySpectrum: no file of counts for 360^3 found; left out")
        return
    pyspectrum.dat_dir = lambda: folder
    counts = pyspectrum._counts_Bk123(Ngrid=360, Nmax=40, Ncut=3, step=3) / 360.0**3
    print("pySpectrum's file: triangles", int((counts > 0).sum()), end="; ordered counts")
    for t, expected in ((1, 1, 1), 54066), ((2, 1, 1), 71166), ((2, 2, 1), 225724), ((2, 2, 2), 470232):
        number = counts[t[0] - 1, t[1] - 1, t[2] - 1]
        print(f" {t} {number:.3f}", end="")
        assert abs(number - expected) < 1e-3
    print()
    low, high = pyspectrum_edge(40, 3), pyspectrum_edge(41, 3)
    number = {}
    for n in 360, 384:
        one = np.rint(np.fft.fftfreq(n) * n).astype(np.int64)
        half = np.arange(n // 2 + 1)
        n2 = one[:, None, None] ** 2 + one[None, :, None] ** 2 + half[None, None, :] ** 2
        ones = np.fft.irfftn(((n2 >= low) & (n2 < high)).astype(float), s=(n, n, n), axes=(0, 1, 2)) * n**3
        number[n] = (ones * ones * ones).sum() / n**3
    print(f"shells (40, 40, 40): its file {counts[39, 39, 39]:.1f}; on 360^3 {number[360]:.1f}", end="; ")
    print(f"on 384^3, where none wraps, {number[384]:.1f}")
    assert abs(number[360] / counts[39, 39, 39] - 1.0) < 1e-9
    print(f"share of its triples that wrap round the mesh: {100 * (1 - number[384] / number[360]):.3f} %")


def pyspectrum_power(pyspectrum):
    """Its Pk_periodic takes the modes of a full mesh out of the half mesh that its deposit returns."""
    pyspectrum.FFT_periodic = lambda xyz, **other: np.zeros((9, 16, 16), np.complex64)
    try:
        pyspectrum.Pk_periodic(np.zeros((3, 5)), Lbox=100.0, Ngrid=16)
        print("pySpectrum's Pk_periodic ran")
    except IndexError as error:
        print("pySpectrum's Pk_periodic fails:", error)


def main():
    parser = argparse.ArgumentParser(description="Asserts what docs/comparing-spectra.md says.")
    parser.add_argument("--library", metavar="PATH", help="fixpair's shared library, target/release/libfixpair.so")
    path = parser.parse_args().library
    if path is not None and not os.path.isfile(path):
        parser.error(f"{path} is not there; `cargo rustc --release --lib --crate-type cdylib` makes target/release/libfixpair.so")
    pylians_power()
    pylians_shot_noise()
    pylians_deposit()
    pylians_bispectrum()
    pyspectrum = import_pyspectrum()
    if pyspectrum is not None:
        folder = pyspectrum.dat_dir()
        pyspectrum_bispectrum(pyspectrum)
        pyspectrum_counts(pyspectrum, folder)
        pyspectrum.dat_dir = lambda: folder
        pyspectrum_power(pyspectrum)
    if path is None:
        print("fixpair's library left out: --library PATH compares it as well")
    else:
        import check_library

        check_library.run(path)


if __name__ == "__main__":
    main()
