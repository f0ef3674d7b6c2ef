"""Triangles of shells, and how many triples of modes close each."""

import ctypes
from typing import Any

import numpy as np

from .._arrays import vector
from .._library import library
from ..threads import current
from ..workspace import scratch


def triangles_of(triangles: Any) -> np.ndarray:
    """Refuses what are not uint32 (T, 3)."""
    triangles = vector(triangles, "triangles", np.uint32)
    if triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(f"triangles must have the shape (T, 3), not {triangles.shape}")
    return triangles


def closed_triangles(edges: Any, centres: Any | None = None) -> np.ndarray:
    """All triangles of shells that close, uint32 (T, 3): i <= j <= k, counted from 0, in lexicographic order.

    edges: increasing values of |n|^2, uint64. centres: one number a shell, with which c_k <= c_i + c_j is asked; without, all that modes may
    close.
    """
    edges = vector(edges, "edges", np.uint64)
    centres = None if centres is None else vector(centres, "centres", length=edges.size - 1)
    count = ctypes.c_size_t()
    library.closed_triangle_count(count, edges, edges.size, centres)
    triangles = np.empty((count.value, 3), np.uint32)
    library.closed_triangles(triangles, count.value, edges, edges.size, centres)
    return triangles


def squeezed_triangles(shell: int, shells: int) -> np.ndarray:
    """The squeezed slice of a shell, uint32 (T, 3): (shell, j, j) for j = shell .. shells - 1."""
    triangles = np.empty((max(shells - shell, 0), 3), np.uint32)
    library.squeezed_triangles(triangles, len(triangles), shell, shells)
    return triangles


def triangle_counts(triangles: Any, edges: Any, n: int) -> np.ndarray:
    """The ordered triples of modes, one of each shell, with k1 + k2 + k3 = 0 on a mesh of side n: uint64, exact. Keep them."""
    triangles, edges = triangles_of(triangles), vector(edges, "edges", np.uint64)
    counts = np.empty(len(triangles), np.uint64)
    arguments = (triangles, len(triangles), edges, edges.size, n)
    with scratch(library.triangle_counts_scratch, *arguments) as (memory, size):
        library.triangle_counts(counts, *arguments, memory, size, current())
    return counts
