"""What the checks share: fixpair's conventions written out in numpy, with every mode of the full mesh spelt out, and a field.

delta(k) = FFT(delta) / N^3; shells edge[b] <= |n|^2 < edge[b+1] of integers |n|^2 = (k L / 2 pi)^2; counts of +k and -k;
P = V sum |delta|^2 / modes; B = V^2 sum delta(k1) delta(k2) delta(k3) / triangles over ordered triples, k1 + k2 + k3 = 0.
"""

import contextlib
import io
import math
import sys
import types

import numpy as np

BOX = 1000.0  # Mpc/h
N = 64
# Pylians's B of k1 and k2 in k_f, and theta in pi. The three upper edges, in k_f, add up to less than N: no triple wraps round the mesh.
TRIANGLES = (5, 5, 2 / 3), (9, 12, 0.5), (7, 7, 0.25), (3, 12, 0.6), (1, 1, 2 / 3)
# pySpectrum's shells in k_f, and how many; the same holds for them.
STEP, SHELLS = 3, 6


class Modes:
    """delta(k) of a real mesh, all N^3 modes, with the integers n = k L / 2 pi."""

    def __init__(self, delta, window=0):
        n = delta.shape[0]
        one = np.rint(np.fft.fftfreq(n) * n).astype(np.int64)
        self.n = np.meshgrid(one, one, one, indexing="ij", sparse=True)
        self.n2 = sum(a * a for a in self.n)
        self.delta = np.fft.fftn(delta.astype(np.float64)) / n**3
        for a in self.n:
            self.delta = self.delta / np.sinc(a / n) ** window  # numpy's sinc(x) is sin(pi x) / (pi x)

    def shell(self, low, high):
        return (self.n2 >= low) & (self.n2 < high)

    def own_conjugates(self):
        """n = -n modulo N: all components 0 or N/2."""
        side = self.n2.shape[0]
        return math.prod((a % (side // 2) == 0) for a in self.n).astype(bool)

    def power(self, shell, volume, axis=2):
        """Modes, mean |n|, and P_0, P_2, P_4 = (2 l + 1) V <|delta|^2 L_l(mu)>."""
        square = np.abs(self.delta[shell]) ** 2
        mu2 = np.broadcast_to(self.n[axis] ** 2, self.n2.shape)[shell] / np.maximum(self.n2[shell], 1)
        legendre = 1.0, 5.0 * (3 * mu2 - 1) / 2, 9.0 * (35 * mu2**2 - 30 * mu2 + 3) / 8
        return shell.sum(), np.sqrt(self.n2[shell]).mean(), [volume * (square * l).mean() for l in legendre]

    def triples(self, *shells):
        """(number of ordered closed triples, sum of delta delta delta over them)."""
        cells = self.n2.size
        fields = [np.fft.ifftn(np.where(s, self.delta, 0.0)).real * cells for s in shells]
        ones = [np.fft.ifftn(s.astype(float)).real * cells for s in shells]
        count = math.prod(ones).sum() / cells
        assert abs(count - np.rint(count)) < 1e-3, "a count is an integer"
        return int(np.rint(count)), math.prod(fields).sum() / cells


def skewed_field(n):
    """A field with a bispectrum far above its noise, and power that falls with k."""
    gauss = np.random.default_rng(5).standard_normal((n, n, n))
    modes = Modes(gauss)
    gauss = np.fft.ifftn(modes.delta * n**3 * np.exp(-modes.n2 / (0.3 * n) ** 2)).real
    gauss /= gauss.std()
    field = np.exp(gauss)
    return (field / field.mean() - 1.0).astype(np.float32)


def second_field(n):
    """One that is correlated with the first."""
    other = Modes(skewed_field(n)[::-1].copy())
    other.delta = other.delta + 0.5 * Modes(skewed_field(n)).delta
    return np.fft.ifftn(other.delta * n**3).real.astype(np.float32)


def pylians_edge(x):
    """The smallest integer |n|^2 with sqrt(|n|^2) >= x in f64: where Pylians's `k >= k_min` begins."""
    m = max(0, math.floor(x * x) - 1)
    while math.sqrt(m) < x:
        m += 1
    return m


def pylians_shells(k):
    """Edges of |n|^2 of Pylians's shell about each k."""
    fundamental = 2.0 * np.pi / BOX
    return [tuple(pylians_edge((one + sign * fundamental) / fundamental) for sign in (-1, 1)) for one in k]


def pyspectrum_edge(i, step):
    """The smallest integer |n|^2 in shell i = floor(|n| / step + 1/2): ceil(step^2 (2 i - 1)^2 / 4)."""
    return -((-(step**2) * (2 * i - 1) ** 2) // 4)


def quiet(call, *arguments, **named):
    with contextlib.redirect_stdout(io.StringIO()):
        return call(*arguments, **named)


def worst(a, b):
    return max(abs(x / y - 1.0) for x, y in zip(a, b, strict=True))


def import_pyspectrum():
    """The module, or None with a line that says why."""
    try:
        import estimator  # noqa: F401  its Fortran part; nothing here calls it
    except ImportError:
        sys.modules["estimator"] = types.ModuleType("estimator")
    try:
        from pyspectrum import pyspectrum
    except ImportError as error:
        print("pySpectrum left out:", error)
        return None
    return pyspectrum
