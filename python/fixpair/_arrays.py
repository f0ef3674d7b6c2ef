"""From numpy arrays to what the library reads and writes: in place, or not at all.

An array of another type, order or alignment than the library needs is an error and never copied. Sequences and numbers, which
have no memory that the library could use, become new arrays where they are only read.
"""

import ctypes
from typing import Any, NamedTuple, Union
from collections.abc import Sequence

import numpy as np

from . import native
from ._library import library

Array = np.ndarray
Particles = Union[np.ndarray, Sequence[np.ndarray]]
"""Three numbers a particle: an array of shape (N, 3) with any stride, a field of a structured array, or three arrays of shape (N,)."""

PRECISIONS = {"f": "f32", "F": "f32", "d": "f64", "D": "f64"}
REALS: dict[str, np.dtype] = {"f32": np.dtype(np.float32), "f64": np.dtype(np.float64)}


def precision(array: Array, name: str) -> str:
    """f32 or f64, of real or complex numbers in the byte order of the machine."""
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{name} must be a numpy array, not {type(array).__name__}")
    real = PRECISIONS.get(array.dtype.char)
    if real is None or not array.dtype.isnative:
        raise TypeError(f"{name} must hold float32 or float64 numbers (or complex of these), not {array.dtype}")
    return real


def real_of(dtype: Any) -> str:
    """f32 or f64 of a numpy dtype."""
    real = PRECISIONS.get(np.dtype(dtype).char)
    if real is None:
        raise TypeError(f"there are kernels for float32 and float64, not for {np.dtype(dtype)}")
    return real


def usable(array: Array, name: str, write: bool) -> None:
    """Refuses memory that cannot be written, or is not aligned to its element."""
    if write and not array.flags.writeable:
        raise ValueError(f"{name} is written, but the array is read-only")
    if not array.flags.aligned:
        raise ValueError(f"{name} is not aligned to its element")


def same(real: str, other: str, name: str) -> None:
    """Refuses arrays of two precisions."""
    if real != other:
        raise TypeError(f"{name} is {REALS[other]}, but the others are {REALS[real]}: precisions are not mixed")


def vector(values: Any, name: str, dtype: Any = np.float64, length: int | None = None, write: bool = False,
           shape: Sequence[int] | None = None) -> Array:
    """A contiguous array of one type: the array itself, or a new one of a sequence that is only read."""
    if not isinstance(values, np.ndarray):
        if write:
            raise TypeError(f"{name} is written and must be a numpy array, not {type(values).__name__}")
        values = np.atleast_1d(np.array(values, dtype))
    dtype = np.dtype(dtype)
    if values.dtype != dtype:
        raise TypeError(f"{name} must hold {dtype} numbers, not {values.dtype}")
    if not values.flags.c_contiguous:
        raise ValueError(f"{name} must be contiguous (numpy.ascontiguousarray makes a copy that is)")
    usable(values, name, write)
    if length is not None and values.size != length:
        raise ValueError(f"{name} must have {length} elements, not {values.size}")
    if shape is not None and values.shape != tuple(shape):
        raise ValueError(f"{name} must have the shape {tuple(shape)}, not {values.shape}")
    return values


def output(out: Array | None, name: str, shape: Any, dtype: Any = np.float64) -> Array:
    """Where a result goes: the caller's array, or a new one."""
    if out is None:
        return np.empty(shape, dtype)
    return vector(out, name, dtype, shape=(shape,) if isinstance(shape, int) else shape, write=True)


def strided(values: Array, name: str, write: bool = False) -> tuple[int, str]:
    """The stride in elements, and the precision, of one number a particle."""
    real = precision(values, name)
    if values.ndim != 1 or values.dtype.kind == "c":
        raise ValueError(f"{name} must be real numbers of shape (N,), not {values.dtype} of shape {values.shape}")
    usable(values, name, write)
    return stride_of([values], name), real


def stride_of(columns: Sequence[Array], name: str) -> int:
    size = columns[0].itemsize
    strides = {column.strides[0] for column in columns} if len(columns[0]) > 1 else {size}
    stride = strides.pop()
    if strides or stride <= 0 or stride % size:
        raise ValueError(f"{name} must go from particle to particle in equal steps of whole elements forwards")
    return stride // size


class Triples(NamedTuple):
    """Particles as the library takes them; `columns` keep the memory alive."""

    structure: native.Structure
    real: str
    particles: int
    columns: tuple


def triples(values: Particles, name: str, write: bool = False) -> Triples:
    """Three numbers a particle, where they are: fixpair_components and fixpair_positions."""
    if isinstance(values, np.ndarray):
        if values.ndim != 2 or values.shape[1] != 3:
            raise ValueError(f"{name} must have the shape (N, 3), not {values.shape}")
        columns = tuple(values[:, axis] for axis in range(3))
    else:
        columns = tuple(values)
        if len(columns) != 3:
            raise ValueError(f"{name} must be an array of shape (N, 3) or three arrays")
    reals = [precision(column, name) for column in columns]
    for column, real in zip(columns, reals):
        same(reals[0], real, name)
        if column.ndim != 1 or column.dtype.kind == "c" or len(column) != len(columns[0]):
            raise ValueError(f"{name} must be three arrays of real numbers of one shape (N,)")
        usable(column, name, write)
    kind = native.Components if write else native.Positions
    places = (column.__array_interface__["data"][0] for column in columns)
    structure = kind(*places, stride_of(columns, name), len(columns[0]))
    return Triples(structure, reals[0], len(columns[0]), columns)


def optional_triples(values: Particles | None, name: str, like: Triples) -> native.Structure | None:
    """The structure of particles that may be left out, as many and of the precision of others."""
    if values is None:
        return None
    found = triples(values, name)
    same(like.real, found.real, name)
    if found.particles != like.particles:
        raise ValueError(f"{name} must be of {like.particles} particles, not {found.particles}")
    # The columns belong to the caller's arrays, which outlive the call.
    return found.structure


class View(NamedTuple):
    """A mesh as the library takes it: an address, reals from there on, and the brick that says what lies where."""

    start: int
    length: int
    brick: native.Structure
    real: str
    array: Array


def view(array: Array, brick: native.Structure | None, space: int, name: str, write: bool = False) -> View:
    """Cells or modes. Without a brick the array shows the whole mesh: reals (n, n, n), or complex numbers (n, n, n/2 + 1).

    With one it is the memory that the brick speaks of, of one dimension, or an array that shows just that part.
    """
    real = precision(array, name)
    fourier = space == native.Space.FOURIER
    usable(array, name, write)
    if brick is None or array.ndim == 3:
        if array.ndim != 3 or (array.dtype.kind == "c") != fourier:
            wanted = "complex numbers (n, n, n/2 + 1)" if fourier else "real numbers (n, n, n)"
            raise ValueError(f"{name} must show {wanted}, or come with a brick; it is {array.dtype} {array.shape}")
        brick = brick_of(array, brick, space, name)
    elif array.ndim != 1 or not array.flags.c_contiguous:
        raise ValueError(f"{name} must be the memory of its brick, of one dimension and contiguous, not {array.shape}")
    if brick.space != space:
        raise ValueError(f"{name} must be on a brick of {native.Space(space).name.lower()} space")
    count = ctypes.c_size_t()
    library.brick_reals(count, brick)
    held = array.size * (2 if array.dtype.kind == "c" else 1)
    length = count.value if array.ndim == 3 else held
    if length < count.value:
        raise ValueError(f"{name} must hold the {count.value} reals of its brick, not {held}")
    return View(array.__array_interface__["data"][0], length, brick, real, array)


def brick_of(array: Array, brick: native.Structure | None, space: int, name: str) -> native.Structure:
    """The brick that an array of three dimensions shows."""
    n = array.shape[0] if brick is None else brick.n
    last = n // 2 + 1 if space == native.Space.FOURIER else n
    shape = (n, n, last) if brick is None else tuple(brick.count)
    if array.shape != shape:
        raise ValueError(f"{name} must have the shape {shape}, not {array.shape}")
    if any(stride <= 0 or stride % array.itemsize for stride in array.strides):
        raise ValueError(f"{name} must go forwards through memory in whole elements on each axis")
    found = native.Brick()
    found.n, found.space = n, space
    found.start[:] = (0, 0, 0) if brick is None else tuple(brick.start)
    found.count[:], found.stride[:] = shape, tuple(stride // array.itemsize for stride in array.strides)
    return found


def alike(views: Sequence[View], names: Sequence[str]) -> int:
    """Reals that all of several meshes hold; refuses those that are not laid out as the first is."""
    first = views[0]
    layout = tuple(first.brick.start), tuple(first.brick.count), tuple(first.brick.stride)
    for found, name in zip(views, names):
        same(first.real, found.real, name)
        if (tuple(found.brick.start), tuple(found.brick.count), tuple(found.brick.stride)) != layout or found.brick.n != first.brick.n:
            raise ValueError(f"{name} must be laid out as {names[0]} is: the same shape and strides")
    return min(found.length for found in views)
