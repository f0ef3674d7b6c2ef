"""A class for each status, all of them :class:`FixpairError`, and what Python calls such a mistake where it has a name for it."""

from .choices import Status


class FixpairError(Exception):
    """A function of the library refused, and its outputs are as they were, unless its documentation says otherwise.

    ``status`` is the :class:`Status`, ``function`` the name in the header without its prefix.
    """

    def __init__(self, message: str, status: int = 0, function: str = ""):
        super().__init__(message)
        self.status = Status(status) if status in Status._value2member_map_ else status
        self.function = function


class NullError(FixpairError, ValueError):
    """A required pointer is null."""


class LengthError(FixpairError, ValueError):
    """An array has the wrong length."""


class AlignmentError(FixpairError, ValueError):
    """A pointer is not aligned to its element."""


class OverlapError(FixpairError, ValueError):
    """Memory that must be separate overlaps."""


class NotFiniteError(FixpairError, ValueError):
    """An input is NaN or infinite."""


class MeshSizeError(FixpairError, ValueError):
    """The mesh side is zero, odd, or has a prime factor that the transform lacks."""


class BrickError(FixpairError, ValueError):
    """A brick does not fit its mesh, its memory, or the function."""


class SizeError(FixpairError, OverflowError):
    """A size does not fit the address space, 2^21 cells a side, or a sum of 64 bits."""


class TableError(FixpairError, ValueError):
    """A table is too short, not increasing, or not positive."""


class RangeError(FixpairError, ValueError):
    """A parameter is out of range."""


class ScratchError(FixpairError, MemoryError):
    """Scratch is smaller than its query says."""


class HookError(FixpairError, RuntimeError):
    """A hook failed or left work undone."""


class VersionError(FixpairError, RuntimeError):
    """A struct_size is unknown, or memory holds something else than it should."""


class ChoiceError(FixpairError, ValueError):
    """An enumeration has an unknown value."""


class ThreadError(FixpairError, RuntimeError):
    """The system refused to start a thread."""


class ConvergenceError(FixpairError, ArithmeticError):
    """An iteration did not converge."""


class OutsideError(FixpairError, ValueError):
    """A particle lies outside the brick of cells, or its window reaches beyond it."""


class Stopped(FixpairError):
    """The observer asked a run to stop; it can go on."""


class SamplesError(FixpairError, ValueError):
    """There are fewer independent estimates than the statistic needs."""


class SingularError(FixpairError, ArithmeticError):
    """A matrix is singular or not positive definite, or the data say nothing about a parameter."""


CLASSES: dict[int, type[FixpairError]] = {
    Status.NULL: NullError, Status.LENGTH: LengthError, Status.ALIGNMENT: AlignmentError, Status.OVERLAP: OverlapError,
    Status.NOT_FINITE: NotFiniteError, Status.MESH_SIZE: MeshSizeError, Status.BRICK: BrickError, Status.OVERFLOW: SizeError,
    Status.TABLE: TableError, Status.RANGE: RangeError, Status.SCRATCH: ScratchError, Status.HOOK: HookError,
    Status.VERSION: VersionError, Status.CHOICE: ChoiceError, Status.THREAD: ThreadError,
    Status.CONVERGENCE: ConvergenceError, Status.OUTSIDE: OutsideError, Status.STOPPED: Stopped,
    Status.SAMPLES: SamplesError, Status.SINGULAR: SingularError,
}


def error_of(status: int, message: str, function: str = "") -> FixpairError:
    """The error of a negative status."""
    return CLASSES.get(status, FixpairError)(message, status, function)
