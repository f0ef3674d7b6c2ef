"""From a seed to particles: in one call, or stage by stage."""

from .conditions import Conditions, initial_conditions, initial_conditions_at, particle_ids
from .png import SHAPE_ROW, add_local, add_shape, shape_rows
from .stages import (
    ThirdOrderSources, copy_modes, displace, displacement, scale_modes, second_order_source, third_order_sources,
    transverse_displacement,
)

__all__ = [
    "Conditions", "SHAPE_ROW", "ThirdOrderSources", "add_local", "add_shape", "copy_modes", "displace", "displacement",
    "initial_conditions", "initial_conditions_at", "particle_ids", "scale_modes", "second_order_source", "shape_rows",
    "third_order_sources", "transverse_displacement",
]
