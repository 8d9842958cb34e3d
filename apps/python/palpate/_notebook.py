"""Clouds and meshes outside this process: pictures for notebooks, and pickles."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from ._errors import Error
from ._palpate import Cloud, Mesh, _Matter, read, write
from ._session import Session


def picture(cloud: Cloud) -> bytes | None:
    """PNG; None where nothing can be drawn, as without points or a GPU."""
    try:
        with Session(cloud) as session:
            return session._repr_png_()
    except Error:  # it cannot be opened
        return None


def picture_of_mesh(mesh: Mesh) -> bytes | None:
    """That of its vertices."""
    return picture(Cloud(mesh.vertices, normals=mesh.normals))


def picture_of_matter(matter: _Matter) -> bytes | None:
    """That of its particles."""
    return picture(Cloud(matter.frame().positions))


def steps(**settings: Any) -> str:
    """Settings of a preparation, as the library reads them."""
    import json

    return json.dumps(settings, default=lambda value: value.tolist())


def reduced(cloud: Cloud) -> tuple[Any, tuple[Any, ...]]:
    """For pickle: the arrays, or a file if there are attributes as well."""
    if not cloud.attributes:
        colors = cloud.colors
        return Cloud, (cloud.xyz, cloud.normals, None if colors is None else colors[:, :3])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cloud.ply"
        write(file, cloud)
        return restored, (file.read_bytes(),)


def restored(data: bytes) -> Cloud:
    """The cloud of such a file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cloud.ply"
        file.write_bytes(data)
        return read(file)
