"""The wheel: built and installed by pip without network, and used as by somebody who has nothing else of palpate."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays

TOP = Path(__file__).resolve().parents[2]
BUILD = Path(pp.__file__).parents[2]
RUNTIME = re.compile(r"(ld-linux.*|lib(c|m|dl|pthread|rt|gcc_s|stdc\+\+))[.-].*")


class Environment:
    """A virtual environment with the wheel, which sees the system's NumPy and no setting of this test."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.python = folder / "venv" / "bin" / "python"
        made(sys.executable, "-m", "venv", "--system-site-packages", folder / "venv")
        self.pip("wheel", "--no-index", "--no-deps", "--config-settings", f"build={BUILD}", "-w", folder,
                 TOP / "apps" / "python")
        (self.wheel,) = folder.glob("*.whl")
        self.pip("install", "--no-index", self.wheel)
        xyz, normals = ball_arrays(5000)
        pp.write(folder / "scan.ply", pp.Cloud(xyz, normals=normals))

    def pip(self, *words: object) -> None:
        made(self.python, "-m", "pip", "-q", "--disable-pip-version-check", *words)

    def run(self, *words: object, **variables: str) -> str:
        return made(self.python, *words, cwd=self.folder, variables=variables)


def made(*words: object, cwd: Path | None = None, variables: dict[str, str] | None = None) -> str:
    environment = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "PYTHONDONTWRITEBYTECODE": "1", **(variables or {})}
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=cwd, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    for module, package in (("venv", "python3-venv"), ("ensurepip", "python3-venv")):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"skipped: the module {module} is not installed ({package})")
    if shutil.which("patchelf") is None:
        pytest.skip("skipped: patchelf is not installed")
    return Environment(tmp_path_factory.mktemp("wheel"))


@pytest.mark.full
def test_the_wheel_is_this_version_with_its_types(environment):
    assert environment.wheel.name.startswith(f"palpate-{pp.__version__}-cp3")
    assert environment.run("-c", "from importlib.metadata import version; print(version('palpate'))").strip() \
        == pp.__version__
    package = environment.python.parents[1] / "lib" / f"python3.{sys.version_info.minor}" / "site-packages" / "palpate"
    assert (package / "py.typed").exists() and (package / "_palpate.pyi").exists()
    assert environment.wheel.stat().st_size < 10e6


@pytest.mark.full
def test_the_example_runs_from_the_wheel_with_no_library_of_the_system_but_the_runtimes(environment):
    assert " N" in environment.run(TOP / "apps" / "examples" / "dent.py", "scan.ply", "dented.ply")
    assert len(pp.read(environment.folder / "dented.ply")) > 4000
    before = set(environment.run("-c", "print(open('/proc/self/maps').read())").split())
    after = environment.run("-c", "import palpate; print(palpate.__file__); print(open('/proc/self/maps').read())")
    libraries = {Path(word) for word in set(after.split()) - before if ".so" in word}
    strangers = [library.name for library in libraries
                 if environment.folder not in library.parents and "lib-dynload" not in library.parts
                 and not RUNTIME.fullmatch(library.name)]
    assert any(library.name.startswith("libpalpate-") for library in libraries)
    assert strangers == []


@pytest.mark.full
def test_the_wheel_is_imported_in_a_tenth_of_a_second(environment):
    def seconds(program: str) -> float:
        text = f"{program}; import resource as r; u = r.getrusage(r.RUSAGE_SELF); print(u.ru_utime + u.ru_stime)"
        return min(float(environment.run("-c", text)) for _ in range(5))

    assert seconds("import palpate") - seconds("pass") < 0.1


@pytest.mark.full
def test_without_a_vulkan_loader_the_cpu_answers_and_a_gpu_is_refused_in_a_sentence(environment):
    for name in ("libvulkan.so", "libvulkan.so.1"):
        (environment.folder / name).write_text("no library")
    np.save(environment.folder / "path.npy", np.column_stack([np.zeros(20), np.zeros(20), np.linspace(51, 49, 20)]))
    said = environment.run("-c", """
import numpy, palpate
cloud = palpate.read("scan.ply")
with palpate.Session(cloud, mm_per_unit=1) as session:
    print(session.touch(numpy.load("path.npy"))["contact"].any())
try:
    palpate.Session(cloud, gpu=0)
except palpate.Error as error:
    print(error)
""", LD_LIBRARY_PATH=str(environment.folder)).splitlines()
    assert said[0] == "True"
    assert len(said) == 2 and "libvulkan1" in said[1]


@pytest.mark.full
def test_removing_the_wheel_leaves_nothing(environment):
    environment.pip("uninstall", "-y", "palpate")
    left = [path for path in (environment.folder / "venv").rglob("*") if "palpate" in path.name]
    assert left == []
