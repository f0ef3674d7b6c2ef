"""Matrices: Cholesky factors, and CARPool with a matrix of coefficients."""

from typing import Any, NamedTuple

import numpy as np

from .._arrays import vector
from .._library import library
from ..workspace import scratch
from .ensemble import rows_of


def covariance_root(covariance: Any) -> np.ndarray:
    """The Cholesky factor L of a covariance C = L L^T: its lower triangle, zeros above."""
    covariance = vector(covariance, "covariance")
    if covariance.ndim != 2 or covariance.shape[0] != covariance.shape[1]:
        raise ValueError(f"a covariance must be square, not {covariance.shape}")
    root = np.empty(covariance.shape)
    with scratch(library.covariance_root_scratch, len(covariance)) as (memory, size):
        library.covariance_root(root, covariance, len(covariance), memory, size)
    return root


class Carpool(NamedTuple):
    """The expectation of y, its covariance, and the coefficients B (values, controls)."""

    mean: np.ndarray
    covariance: np.ndarray
    beta: np.ndarray


def carpool(y: Any, c: Any, mu: Any, *, covariance_of_mu: Any = None) -> Carpool:
    """<y> - B (<c> - mu), B = C_yc (C_cc + N C_mu)^-1: each value corrected by all controls (Chartier et al. 2021, arXiv:2009.08970).

    y: (N, values), c: (N, controls) of the same seeds. covariance_of_mu: of c over N_c, from simulations of their own; None where mu is exact.
    """
    y, c = rows_of(y, "y"), rows_of(c, "c")
    if len(y) != len(c):
        raise ValueError(f"y has {len(y)} samples, c {len(c)}")
    values, controls = y.shape[1], c.shape[1]
    mu = vector(mu, "mu", length=controls)
    if covariance_of_mu is not None:
        covariance_of_mu = vector(covariance_of_mu, "covariance_of_mu", shape=(controls, controls))
    found = Carpool(np.empty(values), np.empty((values, values)), np.empty((values, controls)))
    with scratch(library.carpool_scratch, values, controls) as (memory, size):
        library.carpool(*found, y, c, len(y), values, mu, covariance_of_mu, controls, memory, size)
    return found
