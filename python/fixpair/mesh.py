"""Parts of a mesh: which an array holds, and where each element lies."""

import ctypes
from typing import Any

import numpy as np

from . import native
from ._arrays import REALS, precision, real_of
from ._library import library
from .native import Space, Window
from .workspace import aligned

COMPLEX: dict[str, np.dtype] = {"f32": np.dtype(np.complex64), "f64": np.dtype(np.complex128)}


class Brick(native.Brick):
    """A part of an n x n x n mesh: ``n``, ``space``, and for each axis ``start``, ``count`` and ``stride`` in elements.

    Functions take whole meshes as arrays of three dimensions, whose shape and strides say the same, and need a brick for
    parts alone: for slabs and pencils of a run on many processes.
    """

    @classmethod
    def whole(cls, n: int, space: int = Space.CONFIGURATION, padding: int = 0) -> "Brick":
        """The whole mesh, laid out for a transform in place: rows of n + 2 reals or n/2 + 1 modes.

        padding: unused modes, twice as many reals, after each x plane; see :func:`fixpair.fft.padding`.
        """
        brick = cls()
        library.brick_whole(brick, n, space, padding)
        return brick

    @classmethod
    def of(cls, mesh: "int | native.Structure", space: int) -> "Brick":
        """That of a whole mesh of side n, or a brick itself."""
        return cls.whole(mesh, space) if isinstance(mesh, int) else cls.from_buffer_copy(mesh)

    @classmethod
    def slab(cls, n: int, first: int, planes: int, space: int = Space.CONFIGURATION) -> "Brick":
        """The x planes first .. first + planes - 1, as FFTW-MPI deals out a mesh."""
        brick = cls()
        library.brick_slab(brick, n, space, first, planes)
        return brick

    @classmethod
    def transposed_slab(cls, n: int, first: int, rows: int) -> "Brick":
        """The modes with y index first .. first + rows - 1, y outermost: FFTW_MPI_TRANSPOSED_OUT."""
        brick = cls()
        library.brick_transposed_slab(brick, n, first, rows)
        return brick

    def with_ghosts(self, window: int = Window.CIC, shift: float = 0.0) -> "Brick":
        """The cells that the particles of this brick touch: it, and ghost planes before and after it. May run over the edge."""
        brick = Brick()
        library.brick_with_ghosts(brick, self, window, shift)
        return brick

    @property
    def reals(self) -> int:
        """Reals that its memory must at least have."""
        reals = ctypes.c_size_t()
        library.brick_reals(reals, self)
        return reals.value

    @property
    def shape(self) -> tuple[int, int, int]:
        """Elements on each axis."""
        return tuple(self.count)

    def view(self, memory: np.ndarray) -> np.ndarray:
        """Its elements in memory of one dimension, without a copy: reals in configuration space, else complex numbers."""
        real = precision(memory, "memory")
        if memory.ndim != 1 or not memory.flags.c_contiguous or memory.dtype != REALS[real]:
            raise ValueError("memory must be real numbers, of one dimension and contiguous")
        if memory.size < self.reals:
            raise ValueError(f"memory must hold the {self.reals} reals of the brick, not {memory.size}")
        if self.space == Space.FOURIER:
            memory = memory[:memory.size // 2 * 2].view(COMPLEX[real])
        strides = tuple(stride * memory.itemsize for stride in self.stride)
        return np.lib.stride_tricks.as_strided(memory, self.shape, strides)

    def zeros(self, dtype: Any = np.float64) -> np.ndarray:
        """New memory of the brick, on a cache line, as :meth:`view` shows it."""
        memory = aligned(self.reals, REALS[real_of(dtype)])
        memory[:] = 0
        return self.view(memory)
