"""The words that arguments can be, for type checkers. A test compares them with the program's table of settings."""

from __future__ import annotations

from typing import Literal

BrushKind = Literal["push", "carve", "inflate", "smooth", "grab", "paint", "flatten"]
BuiltinPath = Literal["press", "slide", "scan", "orbit", "stir"]  # in water and sand press and stir, else all but stir
ColorBy = Literal["rgb", "normal", "depth", "height"]
MeshSurface = Literal["sphere", "average", "sharp", "density"]
SurfaceKind = Literal["average", "sphere", "sharp"]
ToolKind = Literal["point", "pad", "ball", "spatula"]

__all__ = ["BrushKind", "BuiltinPath", "ColorBy", "MeshSurface", "SurfaceKind", "ToolKind"]
