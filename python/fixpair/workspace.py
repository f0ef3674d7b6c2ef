"""Memory that kernels work in."""

import contextlib
import threading
from contextvars import ContextVar
from typing import Any
from collections.abc import Callable, Iterator

import numpy as np

from . import native

LINE = 64
"""Bytes of a cache line, to which scratch, tables and meshes are aligned."""


def aligned(count: int, dtype: Any = np.uint8) -> np.ndarray:
    """An array that begins on a cache line; its contents are anything."""
    dtype = np.dtype(dtype)
    memory = np.empty(count * dtype.itemsize + LINE, np.uint8)
    skip = -memory.__array_interface__["data"][0] % LINE
    return memory[skip:skip + count * dtype.itemsize].view(dtype)


class Workspace:
    """Scratch that many calls share, instead of some that each allocates and gives back.

    ::

        with fixpair.Workspace():
            for realisation in realisations:
                ...                       # no call allocates scratch that an earlier one had

    It grows to what the largest call asks for, and is used by one call at a time: another that comes meanwhile, from an
    observer or a thread, has memory of its own.
    """

    def __init__(self, size: int = 0):
        self._memory = aligned(size)
        self._free = threading.Lock()

    def __enter__(self) -> "Workspace":
        _blocks.set((*_blocks.get(), self))
        return self

    def __exit__(self, *_: object) -> None:
        _blocks.set(_blocks.get()[:-1])

    @property
    def size(self) -> int:
        """Bytes that it holds."""
        return self._memory.size

    @contextlib.contextmanager
    def borrow(self, size: int) -> Iterator[np.ndarray]:
        """At least so many bytes, for the time of a call."""
        if not self._free.acquire(blocking=False):
            yield aligned(size)
            return
        try:
            if self._memory.size < size:
                self._memory = aligned(size)
            yield self._memory
        finally:
            self._free.release()


# Blocks that this thread is in, the innermost last.
_blocks: ContextVar[tuple[Workspace, ...]] = ContextVar("fixpair_workspaces", default=())


@contextlib.contextmanager
def scratch(query: Callable[..., None], *arguments: Any) -> Iterator[tuple[np.ndarray, int]]:
    """The scratch that a query says, and its length: from the workspace at hand, or new."""
    layout = native.Layout()
    query(layout, *arguments)
    blocks = _blocks.get()
    if not blocks:
        yield aligned(layout.size), layout.size
    else:
        with blocks[-1].borrow(layout.size) as memory:
            yield memory, memory.size
