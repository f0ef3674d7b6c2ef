"""Three-dimensional real transforms: the built-in one, or the host's own."""

import contextlib
import threading
from typing import Any
from collections.abc import Callable, Iterator

import ctypes

import numpy as np

from . import native
from ._arrays import REALS, precision, real_of, vector
from ._library import library, twin
from .mesh import Brick
from .native import Space
from .threads import current
from .workspace import aligned


def next_side(least: int) -> int:
    """The smallest side of the built-in transform (even, factors 2, 3, 5, 7) not below `least`; 0 if there is none.

    For products without aliasing: next_side(3 * n // 2), or next_side(2 * n) with g_nl.
    """
    return library.fft_next_side(least)


def padding(n: int, dtype: Any = np.float64) -> int:
    """Modes after each plane with which the built-in transform of side n is fastest."""
    return twin("fft_padding", real_of(dtype))(n)


class Transform:
    """A transform of n x n x n cells, in place, as kernels take it: :class:`Fft` and :class:`HostFft`.

    Its data is one array of ``length`` reals, that :meth:`mesh` makes; :meth:`cells` shows it as real numbers (n, n, n),
    :meth:`modes` as complex numbers (n, n, n/2 + 1), both of which are the same memory.

    One call at a time runs on it: threads of Python that share one wait for each other.
    """

    n: int
    dtype: np.dtype
    length: int
    configuration: Brick
    fourier: Brick

    def __init__(self, n: int, dtype: Any, pad: int):
        self.n, self.real = n, real_of(dtype)
        self.dtype = REALS[self.real]
        self.configuration = Brick.whole(n, Space.CONFIGURATION, pad)
        self.fourier = Brick.whole(n, Space.FOURIER, pad)
        self.length = max(self.configuration.reals, self.fourier.reals)
        self._lock = threading.RLock()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.n}, {self.dtype})"

    @contextlib.contextmanager
    def use(self) -> Iterator[native.Structure]:
        """The structure of the hook, for one call of the library."""
        raise NotImplementedError

    def mesh(self) -> np.ndarray:
        """New data of ``length`` reals, zeros, on a cache line."""
        data = aligned(self.length, self.dtype)
        data[:] = 0
        return data

    def cells(self, data: np.ndarray) -> np.ndarray:
        """The data as real numbers (n, n, n), without a copy."""
        return self.configuration.view(self.check(data))

    def modes(self, data: np.ndarray) -> np.ndarray:
        """The data as complex numbers (n, n, n/2 + 1), without a copy."""
        return self.fourier.view(self.check(data))

    def check(self, data: np.ndarray, name: str = "data", write: bool = False) -> np.ndarray:
        """Refuses what is not data of this transform."""
        precision(data, name)
        return vector(data, name, self.dtype, shape=(self.length,), write=write)

    def forward(self, data: np.ndarray) -> np.ndarray:
        """F(k) = sum_x f(x) exp(-i k.x), in place; returns the modes."""
        self._run("forward", data)
        return self.modes(data)

    def inverse(self, data: np.ndarray) -> np.ndarray:
        """f(x) = sum_k F(k) exp(+i k.x), in place and not divided by n^3; returns the cells."""
        self._run("inverse", data)
        return self.cells(data)

    def _run(self, way: str, data: np.ndarray) -> None:
        self.check(data, write=True)
        with self.use() as hook:
            if getattr(hook, way)(hook.context, data.__array_interface__["data"][0]) != 0:
                raise native.HookError(f"the {way} transform gave up", native.Status.HOOK, way)

    def self_test(self) -> None:
        """Tries sign, normalisation, order of axes and both directions with plane waves; HookError if one is wrong."""
        with self.use() as hook:
            twin("fft_self_test", self.real)(hook, self.mesh(), self.length)


class Fft(Transform):
    """The built-in transform of side n: even, with no prime factor but 2, 3, 5, 7.

    It runs on the threads of the block that it is used in. Its bits depend on the data, n and the instructions of the
    processor alone.

    dtype: float64 or float32. pad: unused modes after each plane; by default those with which it is fastest.
    """

    def __init__(self, n: int, dtype: Any = np.float64, pad: int | None = None):
        super().__init__(n, dtype, padding(n, dtype) if pad is None else pad)
        self.pad = padding(n, dtype) if pad is None else pad
        layout = native.Layout()
        twin("fft_tables_scratch", self.real)(layout, n)
        self._tables = aligned(layout.size)
        twin("fft_tables_init", self.real)(self._tables, layout.size, n)
        twin("fft_scratch", self.real)(layout, n)
        self._scratch = aligned(layout.size)
        with self.use() as hook:
            # That of the bricks, and what lies behind the last plane.
            self.length = hook.length

    @contextlib.contextmanager
    def use(self) -> Iterator[native.Structure]:
        with self._lock:
            hook = native.Fft()
            twin("fft_init", self.real)(hook, self._tables, self._tables.size, self.pad, self._scratch, self._scratch.size,
                                        current())
            yield hook


Rfftn = Callable[..., np.ndarray]


class HostFft(Transform):
    """The host's transform: a pair of functions like numpy.fft.rfftn and irfftn, scipy.fft's, or pyfftw.interfaces'.

    ::

        fft = fixpair.HostFft(64, numpy.float32, scipy.fft.rfftn, scipy.fft.irfftn)
        fft.self_test()

    rfftn(cells) returns modes (n, n, n/2 + 1) that are not divided; irfftn(modes, s=(n, n, n), axes=(0, 1, 2)) returns cells that are divided by
    n^3, which is undone here. What they return is copied into the mesh. An exception in one ends the kernel with its outputs
    undefined, and is raised.
    """

    def __init__(self, n: int, dtype: Any = np.float64, rfftn: Rfftn = np.fft.rfftn, irfftn: Rfftn = np.fft.irfftn):
        super().__init__(n, dtype, 0)
        self._rfftn, self._irfftn = rfftn, irfftn
        self._error: BaseException | None = None
        self._hook = native.Fft(ctypes.sizeof(native.Fft), None, native.Pass(self._forward), native.Pass(self._inverse),
                                native.Sum(), self.configuration, self.fourier, self.length)

    @contextlib.contextmanager
    def use(self) -> Iterator[native.Structure]:
        with self._lock:
            self._error = None
            try:
                yield self._hook
            except native.HookError:
                error, self._error = self._error, None
                if error is None:
                    raise
                raise error
            finally:
                self._error = None

    def _memory(self, start: int) -> np.ndarray:
        size = self.length * self.dtype.itemsize
        return np.ctypeslib.as_array((ctypes.c_uint8 * size).from_address(start)).view(self.dtype)

    def _forward(self, _: Any, start: int) -> int:
        def run(data: np.ndarray) -> None:
            self.modes(data)[...] = self._rfftn(self.cells(data))
        return self._caught(run, start)

    def _inverse(self, _: Any, start: int) -> int:
        def run(data: np.ndarray) -> None:
            cells = self._irfftn(self.modes(data), s=(self.n,) * 3, axes=(0, 1, 2))
            # In the precision of the mesh, whichever the function answers in.
            np.multiply(cells, float(self.n)**3, out=self.cells(data), casting="same_kind")
        return self._caught(run, start)

    def _caught(self, run: Callable[[np.ndarray], None], start: int) -> int:
        """An exception must not travel through the library: it waits here."""
        try:
            run(self._memory(start))
        except BaseException as error:  # noqa: BLE001
            self._error = error
            return -1
        return 0
