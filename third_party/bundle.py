"""Makes a tree of programs and libraries independent of other packages of the system: copies the libraries that they
need into a folder of the tree, and lets each file find them there, wherever the tree is moved to.

bundle.py TREE FOLDER [--rename]

The C and C++ runtimes remain the system's, as the policies of Python's wheels (manylinux) demand. FOLDER also receives
NOTICES, the copyright files of the Debian packages that the libraries come from. With --rename the name of each library
contains a hash of its content, so that a process can contain another version of the same library, too.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

# The runtimes of C and C++, which exist on each system and exist once in a process.
RUNTIME = re.compile(r"(ld-linux.*|linux-vdso|lib(c|m|dl|pthread|rt|resolv|util|gcc_s|stdc\+\+))\.so\.\d+")


class BundleError(Exception):
    """A sentence for the user."""


def output(*command: str) -> str:
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except FileNotFoundError:
        raise BundleError(f"{command[0]} is not installed; apt-get install {command[0]}") from None
    except subprocess.CalledProcessError as error:
        raise BundleError(f"{' '.join(command)}: {error.stderr.strip()}") from None


def is_elf(file: pathlib.Path) -> bool:
    if file.is_symlink() or not file.is_file():
        return False
    with file.open("rb") as opened:
        return opened.read(4) == b"\x7fELF"


def libraries_of(file: pathlib.Path) -> dict[str, pathlib.Path]:
    """Where the loader finds the libraries that a file needs directly or indirectly, except for the runtimes."""
    found = {}
    for line in output("ldd", str(file)).splitlines():
        name, arrow, path = line.strip().partition(" => ")
        if not arrow or RUNTIME.fullmatch(name):
            continue
        if path.startswith("not found"):
            raise BundleError(f"{file}: needs {name}, which was not found")
        found[name] = pathlib.Path(path.rsplit(" (", 1)[0])
    return found


def notice_of(library: pathlib.Path) -> tuple[str, str]:
    """Name and copyright file of the Debian package of a library; nothing for one of this tree."""
    for path in (library, library.resolve(), pathlib.Path("/usr", *library.resolve().parts[1:])):
        asked = subprocess.run(["dpkg-query", "--search", str(path)], capture_output=True, text=True)
        if asked.returncode == 0:
            package = asked.stdout.split(":", 1)[0]
            return package, pathlib.Path("/usr/share/doc", package, "copyright").read_text(errors="replace")
    return "", ""


def bundle(tree: pathlib.Path, folder: pathlib.Path, rename: bool = False) -> None:
    tree, folder = tree.resolve(), folder.resolve()
    own = [file for file in sorted(tree.rglob("*")) if is_elf(file)]
    wanted: dict[str, pathlib.Path] = {}
    for file in own:
        wanted |= {name: path for name, path in libraries_of(file).items() if tree not in path.resolve().parents}
    folder.mkdir(parents=True, exist_ok=True)
    names, notices = {}, {}
    for name, path in sorted(wanted.items()):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]
        names[name] = name.replace(".so", f"-{digest}.so", 1) if rename else name
        shutil.copyfile(path, folder / names[name])
        (folder / names[name]).chmod(0o755)
        package, text = notice_of(path)
        if package:
            notices[package] = text
    for file in own + [folder / name for name in names.values()]:
        places = [] if file.parent == folder else output("patchelf", "--print-rpath", str(file)).strip().split(":")
        to_folder = os.path.relpath(folder, file.parent)
        place = "$ORIGIN" if to_folder == "." else f"$ORIGIN/{to_folder}"
        inside = [old for old in places if old.startswith("$ORIGIN") and not rename]  # libraries of the tree itself
        # One change for each call: patchelf 0.14 confuses the names of several.
        for needed in output("patchelf", "--print-needed", str(file)).split():
            if names.get(needed, needed) != needed:
                output("patchelf", "--replace-needed", needed, names[needed], str(file))
        if rename and file.parent == folder:
            output("patchelf", "--set-soname", file.name, str(file))
        output("patchelf", "--set-rpath", ":".join(dict.fromkeys([*inside, place])), str(file))
    if notices:
        text = "".join(f"==== {package}\n\n{text}\n\n" for package, text in sorted(notices.items()))
        (folder / "NOTICES").write_text(text)


def main() -> None:
    parser = argparse.ArgumentParser(description="Copies the libraries that a tree needs into it.")
    parser.add_argument("tree", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--rename", action="store_true")
    words = parser.parse_args()
    try:
        bundle(words.tree, words.folder, words.rename)
    except BundleError as error:
        sys.exit(f"bundle.py: {error}")


if __name__ == "__main__":
    main()
