"""Power spectra, correlation functions and bispectra, with exact sums."""

from .binning import BIN, Binning, Sums, edges_exact, edges_uniform, edges_wavenumbers
from .bispectrum import (
    bispectrum, bispectrum_normalise, bispectrum_reduced, bispectrum_shot_noise, bispectrum_sums, bispectrum_values, shell_modes,
)
from .correlation import correlation_modes, correlation_sums
from .power import Power, compensate, power_spectrum, power_sums, shot_noise, subtract_shot_noise
from .triangles import closed_triangles, squeezed_triangles, triangle_counts

__all__ = [
    "BIN", "Binning", "Power", "Sums", "bispectrum", "bispectrum_normalise", "bispectrum_reduced", "bispectrum_shot_noise",
    "bispectrum_sums", "bispectrum_values", "closed_triangles", "compensate", "correlation_modes", "correlation_sums",
    "edges_exact", "edges_uniform", "edges_wavenumbers", "power_spectrum", "power_sums", "shell_modes", "shot_noise",
    "squeezed_triangles", "subtract_shot_noise", "triangle_counts",
]
