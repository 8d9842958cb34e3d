"""The words that arguments can be, for type checkers. A test compares them with the program's table of settings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Callable, Literal, TypedDict

Backend = Literal["auto", "vulkan", "cpu"]
BrushKind = Literal["push", "carve", "inflate", "smooth", "grab", "paint", "flatten"]
BuiltinPath = Literal["press", "slide", "scan", "orbit", "stir"]  # in water and sand press and stir, else all but stir
ColorMap = Literal["auto", "viridis", "turbo", "grey", "red-blue", "classes", "terrain"]
MaskKind = Literal["selected", "hidden", "locked", "within", "lock_weights"]
Material = Literal["auto", "clay", "stone", "plaster", "metal", "unlit", "water"]
MeshSurface = Literal["sphere", "average", "sharp", "density"]
Projection = Literal["perspective", "orthographic", "isometric"]
Splats = Literal["auto", "gaussians", "surface"]
Backs = Literal["auto", "hidden", "shown"]
Side = Literal["auto", "front", "back", "left", "right", "top", "bottom", "isometric"]
SurfaceKind = Literal["average", "sphere", "sharp"]
Switch = Literal["auto", "on", "off"]
ToolKind = Literal["point", "pad", "ball", "spatula"]
Validity = Literal["fresh", "held", "none"]


class SessionOptions(TypedDict, total=False):
    """Keywords that all constructors of a Session have; Session describes them."""

    backend: Backend
    surface: SurfaceKind
    radius_mm: float | None
    friction: float
    stiffness_N_per_mm: float
    damping_N_s_per_mm: float
    max_force_N: float
    rate_Hz: float
    budget_us: float
    estimate_normals: bool
    threads: int
    undo_memory_MiB: float
    hands: int
    tool: ToolKind
    tool_points: int
    tool_size_mm: float
    tool_axis: Sequence[float]
    law: Any
    allow_python_law: bool
    on_message: Callable[[str, str], object] | None


__all__ = [
    "Backend",
    "Backs",
    "BrushKind",
    "BuiltinPath",
    "ColorMap",
    "MaskKind",
    "Material",
    "MeshSurface",
    "Projection",
    "SessionOptions",
    "Side",
    "Splats",
    "SurfaceKind",
    "Switch",
    "ToolKind",
    "Validity",
]
