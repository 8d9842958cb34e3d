"""Builds the wheel for pip (PEP 517): the module by CMake, with libpalpate and all libraries that it needs inside.

The Vulkan loader and its drivers remain the system's; without them palpate works on the CPU. The setting `build` of
pip names a configured build folder; the default is build/release, which is configured if it does not exist.
"""

from __future__ import annotations

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]


class UnsupportedOperation(Exception):
    """What pip expects of a backend that makes no archive of its sources."""


def get_requires_for_build_wheel(config_settings: dict[str, str] | None = None) -> list[str]:
    return []


def build_sdist(sdist_directory: str, config_settings: dict[str, str] | None = None) -> str:
    raise UnsupportedOperation("a source archive is not supported; build the wheel in the source tree of palpate")


def build_wheel(wheel_directory: str, config_settings: dict[str, str] | None = None,
                metadata_directory: str | None = None) -> str:
    build = pathlib.Path((config_settings or {}).get("build", TOP / "build" / "release"))
    if not (build / "CMakeCache.txt").exists():
        run("cmake", "--preset", "release", "-S", str(TOP), "-B", str(build))
    run("cmake", "--build", str(build), "--target", "palpate_library", "palpate_python")
    with tempfile.TemporaryDirectory() as scratch:
        for component in ("library", "python"):
            run("cmake", "--install", str(build), "--prefix", scratch, "--component", component, "--strip")
        tree = pathlib.Path(scratch, "lib", "python3", "dist-packages")
        check_python(tree / "palpate", build)
        run(sys.executable, str(TOP / "third_party" / "bundle.py"), str(tree), str(tree / "palpate.libs"), "--rename")
        version = version_of(build)
        name = f"palpate-{version}-{tag()}.whl"
        information = tree / f"palpate-{version}.dist-info"
        information.mkdir()
        (information / "METADATA").write_text(metadata(version))
        (information / "WHEEL").write_text(
            f"Wheel-Version: 1.0\nGenerator: palpate\nRoot-Is-Purelib: false\nTag: {tag()}\n")
        notices = build / "debian" / "third-party-notices"  # of what is compiled in
        if notices.exists():
            (information / "NOTICES").write_bytes(notices.read_bytes())
        write(tree, information, pathlib.Path(wheel_directory, name))
    return name


def run(*command: str) -> None:
    if subprocess.run(command, stdout=sys.stderr).returncode != 0:
        sys.exit(f"palpate: {' '.join(command)}: failed")


def check_python(package: pathlib.Path, build: pathlib.Path) -> None:
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    if (package / f"_palpate{suffix}").exists():
        return
    others = ", ".join(module.name for module in package.glob("_palpate.*.so")) or "no module"
    sys.exit(f"palpate: {build} has {others}, but pip runs in {sys.executable}, whose modules end in {suffix}; "
             f"configure it with -DPython3_EXECUTABLE={sys.executable}")


def version_of(build: pathlib.Path) -> str:
    found = re.search(r"^CMAKE_PROJECT_VERSION:STATIC=(.+)$", (build / "CMakeCache.txt").read_text(), re.M)
    if found is None:
        sys.exit(f"palpate: {build}/CMakeCache.txt: no CMAKE_PROJECT_VERSION; configure it again")
    return found[1]


def tag() -> str:
    """The module runs with this version of Python, and where glibc is at least as new as on this machine (PEP 600).

    Systems with that glibc have the C++ runtime of the same year or a newer one.
    """
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    glibc = (os.confstr("CS_GNU_LIBC_VERSION") or "").split()[-1].replace(".", "_")
    return f"{python}-{python}-manylinux_{glibc}_{os.uname().machine}"


def metadata(version: str) -> str:
    project = tomllib.loads((HERE / "pyproject.toml").read_text())["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}",
             f"Summary: {project['description']}", "License: none has been chosen by the owner; all rights reserved",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {dependency}" for dependency in project["dependencies"]]
    lines += [f"Classifier: {classifier}" for classifier in project["classifiers"]]
    lines += ["Description-Content-Type: text/markdown", "", (HERE / project["readme"]).read_text()]
    return "\n".join(lines)


def write(tree: pathlib.Path, information: pathlib.Path, wheel: pathlib.Path) -> None:
    """An archive of the tree, the same bytes for the same files; under its final name only once it is complete."""
    unfinished = wheel.with_suffix(".unfinished")
    records = []
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:

        def add(name: str, content: bytes, mode: int) -> None:
            entry = zipfile.ZipInfo(name)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100000 | mode) << 16
            archive.writestr(entry, content)

        for file in sorted(tree.rglob("*")):
            if file.is_dir():
                continue
            name, content = file.relative_to(tree).as_posix(), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            records.append(f"{name},sha256={digest},{len(content)}\n")
            add(name, content, file.stat().st_mode & 0o777)
        record = f"{information.name}/RECORD"
        add(record, "".join([*records, f"{record},,\n"]).encode(), 0o644)
    unfinished.replace(wheel)
