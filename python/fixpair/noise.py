"""Random modes: one seed is one universe, whatever the threads, the decomposition and the machine.

Unit modes w have <|w|^2> = 1, are Hermitian, and are zero at k = 0. Fixed ones have |w| = 1 (Avila & Adame 2022,
arXiv:2204.11103); the phase is 2 pi u1 and the modulus sqrt(-ln u2), and fixing uses the same u1, so that fixed and normal modes are matched.
"""

from typing import Any

import numpy as np

from . import native
from ._arrays import output, vector, view
from ._library import library, twin
from ._members import Members
from .fft import Transform
from .mesh import Brick
from .native import Space
from .threads import current


class Realisation(Members, native.Realisation):
    """One realisation of the Gaussian field.

    seed, and by name: scheme (:class:`~fixpair.Scheme`), amplitude (:class:`~fixpair.Amplitude`), phase
    (:class:`~fixpair.Phase`), nyquist (:class:`~fixpair.Nyquist`), selection (:class:`~fixpair.Selection`), sample: twice the largest
    mode number that is drawn, 0 for the side of the mesh. By default native, normal, original, Nyquist modes zero, all others drawn.
    """

    def __init__(self, seed: int = 0, **members: Any):
        super().__init__()
        library.realisation_init(self, seed)
        self._set(members)


def white_modes(mesh: int | native.Structure, realisation: native.Structure, *, dtype: Any = np.float64,
                amplitude: np.ndarray | None = None, out: np.ndarray | None = None) -> np.ndarray:
    """Unit modes w; with a table of amplitudes, w times amplitude[|n|^2], n = k L/(2 pi).

    mesh: the side n, or a Brick of Fourier space, any part of any mesh. amplitude: float64, 3 (n/2)^2 + 1 or more factors, as
    :func:`fixpair.cosmology.potential_amplitude_table` gives. out: complex numbers (n, n, n/2 + 1), or memory of the brick; new if None, of the
    precision of dtype. Single precision is the rounded double precision. Returns the modes.
    """
    brick = Brick.of(mesh, Space.FOURIER)
    if out is None:
        out = brick.zeros(dtype)
    where = view(out, brick, Space.FOURIER, "out", write=True)
    table = None if amplitude is None else vector(amplitude, "amplitude")
    twin("white_modes", where.real)(where.start, where.length, where.brick, realisation, table,
                                    0 if table is None else table.size, current())
    return out


def impose(modes: np.ndarray, realisation: native.Structure, *, brick: native.Structure | None = None) -> np.ndarray:
    """Imposes the realisation's amplitude, phase, Nyquist choice and selection on unit modes of your own, in place.

    Normal keeps w; fixed makes it w/|w|, or 1 where w = 0. modes: complex numbers (n, n, n/2 + 1), or memory of the brick.
    """
    where = view(modes, brick, Space.FOURIER, "modes", write=True)
    twin("impose", where.real)(where.start, where.length, where.brick, realisation, current())
    return modes


def modes_from_field(data: np.ndarray, fft: Transform, realisation: native.Structure) -> np.ndarray:
    """Unit modes from your own white noise on cells (independent numbers of unit variance), in place.

    data: of ``fft.mesh()``, with the noise in ``fft.cells(data)``. Transforms, multiplies by n^(-3/2), and imposes as :func:`impose`.
    Returns ``fft.modes(data)``.
    """
    fft.check(data, write=True)
    with fft.use() as hook:
        twin("modes_from_field", fft.real)(data, data.size, hook, realisation, current())
    return fft.modes(data)


def philox4x32_10(counter: Any, key: Any) -> np.ndarray:
    """One block of Philox4x32-10 (Salmon et al. 2011): 4 random words of 4 and 2 uint32.

    The native scheme uses counters (i, l, j, 0x77686974) for the mode (i, j, l), and the halves of the seed as key.
    """
    words = np.empty(4, np.uint32)
    library.philox4x32_10(words, vector(counter, "counter", np.uint32, 4), vector(key, "key", np.uint32, 2))
    return words


def ranlxd1(count: int, seed: int) -> np.ndarray:
    """The first numbers of GSL's ranlxd1 (Luescher 1994), in [0, 1): the generator of the schemes NGENIC and FASTPM."""
    uniforms = np.empty(count)
    library.ranlxd1(uniforms, count, seed)
    return uniforms


def ngenic_seeds(mesh: int | native.Structure, seed: int, *, out: np.ndarray | None = None) -> np.ndarray:
    """The seeds of the streams of the schemes NGENIC and FASTPM: N-GenIC's table, uint32, for the columns (i, j) of a mesh or brick."""
    brick = Brick.of(mesh, Space.FOURIER)
    seeds = output(out, "out", tuple(brick.count[:2]), np.uint32)
    library.ngenic_seeds(seeds, seeds.size, brick, seed)
    return seeds
