"""Threads that kernels run on."""

import ctypes
import weakref
from contextvars import ContextVar

from . import native
from ._library import library


class Threads:
    """A pool of threads, for all calls of its block.

    ::

        with fixpair.Threads(4):
            fixpair.deposit(mesh, position, box_size)

    Results never depend on it, bit for bit. The calling thread is one of them; the others sleep between kernels. Outside of
    a block, and in threads of Python that have none of their own, the calling thread does all the work. While a kernel runs,
    other threads of Python do too.

    The pool lives as long as this object. count: 1 to 4096.
    """

    def __init__(self, count: int):
        pool = ctypes.c_void_p()
        self.count = count
        self._exec = native.Exec()
        library.threads_create(pool, self._exec, count)
        weakref.finalize(self, library.threads_destroy, pool)

    def __enter__(self) -> "Threads":
        _blocks.set((*_blocks.get(), self))
        return self

    def __exit__(self, *_: object) -> None:
        _blocks.set(_blocks.get()[:-1])

    def self_test(self) -> None:
        """Checks that each index of loops of several lengths is run exactly once; HookError if not."""
        library.exec_self_test(self._exec)


# Blocks that this thread is in, the innermost last.
_blocks: ContextVar[tuple[Threads, ...]] = ContextVar("fixpair_threads", default=())


def current() -> native.Structure | None:
    """What a kernel's argument `exec` is: that of the innermost block, or none."""
    blocks = _blocks.get()
    return blocks[-1]._exec if blocks else None
