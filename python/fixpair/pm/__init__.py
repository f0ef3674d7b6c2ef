"""The particle mesh: deposit, force, kick, drift, and whole runs."""

from .deposit import add_cells, copy_cells, deposit, interlace, read_out
from .evolve import Displacements, Gravity, Outputs, Run, evolve
from .force import ForceLaw, force, forces, potential
from .step import drift, drift_factors, kick, kick_factors, linear_steps, logarithmic_steps

__all__ = [
    "Displacements", "ForceLaw", "Gravity", "Outputs", "Run", "add_cells", "copy_cells", "deposit", "drift", "drift_factors",
    "evolve", "force", "forces", "interlace", "kick", "kick_factors", "linear_steps", "logarithmic_steps", "potential", "read_out",
]
