"""clang-tidy over the sources of engine, haptics and apps (lint.sh).

lint.py BUILD [FILE...]: BUILD is a configured build folder without precompiled headers.

Most of clang-tidy's time goes into system headers. So sources that have the same flags are read together, in batches
that no two sources with the same file-local name share; a batch that does not compile is checked file by file. The
hash of everything that a batch reads is kept in BUILD/clean once the batch has no finding.
"""

from __future__ import annotations

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

TOP = pathlib.Path(__file__).resolve().parents[1]
ROOMS = ("engine", "haptics", "apps")
MAX_BATCH = 8
OWN_OPTIONS = ("-Wno-unknown-warning-option",)
FINDING = re.compile(r"^(/[^:\n]+):(\d+):\d+: (?:error|warning): .*\[([\w.,-]+)\]$", re.MULTILINE)


class Source:
    """A source, and the flags of its compiler that clang understands and that change what it reads."""

    def __init__(self, entry: dict[str, str]) -> None:
        self.path = pathlib.Path(entry["file"]).resolve()
        self.name = self.path.relative_to(TOP).as_posix()
        self.flags: list[str] = []
        words = shlex.split(entry["command"])
        for i, word in enumerate(words):
            if word.startswith(("-I", "-D", "-std=")):
                self.flags.append(word)
            elif word == "-isystem":
                self.flags += [word, words[i + 1]]

    @functools.cached_property
    def local_names(self) -> frozenset[str]:
        """Names in the unnamed namespaces of the source; some more may be among them."""
        names: set[str] = set()
        depth = 0
        for line in self.path.read_text(encoding="utf-8").splitlines():
            if line == "namespace {":
                depth += 1
            elif line == "}  // namespace":
                depth -= 1
            elif depth > 0 and re.match(r"[A-Za-z]", line) and not line.startswith("namespace"):
                names.update(re.findall(r"\b(\w+)(?=\s*[({=\[;])", line))
                names.update(re.findall(r"\b(?:struct|class|enum class|enum) (\w+)", line))
        return frozenset(names)


def sources_of(build: pathlib.Path, wanted: list[str]) -> list[Source]:
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    found: dict[str, Source] = {}
    for entry in entries:
        path = pathlib.Path(entry["file"]).resolve()
        if path.suffix == ".cpp" and path.is_relative_to(TOP) and path.relative_to(TOP).parts[0] in ROOMS:
            source = Source(entry)
            found.setdefault(source.name, source)
    if wanted:
        names = [pathlib.Path(name).resolve().relative_to(TOP).as_posix() for name in wanted]
        if unknown := [name for name in names if name not in found]:
            sys.exit(f"lint.py: not a source that this machine builds: {', '.join(unknown)}")
        return [found[name] for name in names]
    return [found[name] for name in sorted(found)]


def batches_of(sources: list[Source]) -> list[list[Source]]:
    """Sources with the same flags together, as far as their local names differ."""
    batches: dict[tuple[str, ...], list[tuple[list[Source], set[str]]]] = {}
    for source in sources:
        open_ones = batches.setdefault(tuple(source.flags), [])
        for batch, names in open_ones:
            if len(batch) < MAX_BATCH and names.isdisjoint(source.local_names):
                batch.append(source)
                names |= source.local_names
                break
        else:
            open_ones.append(([source], set(source.local_names)))
    return [batch for open_ones in batches.values() for batch, _ in open_ones]


@functools.cache
def read(path: pathlib.Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


@functools.cache
def includes_of(path: pathlib.Path) -> tuple[str, ...]:
    text = (read(path) or b"").decode("utf-8", "replace")
    return tuple(re.findall(r'^\s*#\s*include\s*["<]([^">]+)[">]', text, re.MULTILINE))


def headers_of(batch: list[Source]) -> list[pathlib.Path]:
    """Headers of the tree and of the build that the batch may read; those of the system count by their packages."""
    folders = [pathlib.Path(flag[2:]) for flag in batch[0].flags if flag.startswith("-I")]
    folders += [pathlib.Path(flag) for before, flag in zip(batch[0].flags, batch[0].flags[1:]) if before == "-isystem"]
    folders = [folder for folder in folders if folder.is_relative_to(TOP)]
    seen: set[pathlib.Path] = set()
    left = [source.path for source in batch]
    while left:
        path = left.pop()
        if path in seen:
            continue
        seen.add(path)
        for name in includes_of(path):
            left += [folder / name for folder in (path.parent, *folders) if read(folder / name) is not None]
    return sorted(seen)


@functools.cache
def surroundings() -> bytes:
    """What every result depends on: the checks, clang-tidy, the system's headers and this script."""
    packages = subprocess.run(["dpkg-query", "-W", "*-dev", "clang-tidy*"], capture_output=True).stdout
    return b"\0".join([(TOP / ".clang-tidy").read_bytes(), packages, pathlib.Path(__file__).read_bytes()])


def hash_of(batch: list[Source]) -> str:
    told = hashlib.sha256(surroundings())
    told.update("\0".join(batch[0].flags).encode())
    for path in headers_of(batch):
        told.update(str(path).encode() + b"\0" + (read(path) or b"") + b"\0")
    return told.hexdigest()


def run_tidy(file: pathlib.Path, flags: list[str], *options: str) -> str:
    command = ["clang-tidy", "--quiet", f"--config-file={TOP / '.clang-tidy'}", *options, str(file), "--"]
    done = subprocess.run([*command, *flags, *OWN_OPTIONS], cwd=TOP, capture_output=True, text=True, errors="replace")
    if done.returncode != 0 and not FINDING.search(done.stdout):
        why = done.stderr.strip()[-500:]
        return f"{file}:1:1: error: clang-tidy failed ({done.returncode}): {why!r} [clang-tidy]\n"
    return done.stdout


def check(build: pathlib.Path, batch: list[Source]) -> str:
    """Findings in the batch, as clang-tidy prints them; empty if it is clean."""
    digest = hash_of(batch)
    clean = build / "clean" / digest
    if clean.exists():
        return ""
    if len(batch) == 1:
        text = run_tidy(batch[0].path, batch[0].flags)
    else:
        together = build / "together" / f"{digest}.cpp"
        together.write_text("".join(f'#include "{source.name}"\n' for source in batch), encoding="utf-8")
        text = run_tidy(together, batch[0].flags, "--checks=-bugprone-suspicious-include")
        together.unlink()
        if why := re.search(r".*error: .*\[clang-diagnostic-error.*", text):
            print(f"lint.py: {batch[0].name} and {len(batch) - 1} more go one by one: {why[0]}", flush=True)
            return "".join(check(build, [source]) for source in batch)
    if not text:
        clean.touch()
    return text


def findings_of(text: str) -> dict[tuple[str, str, str], str]:
    """Each finding with its notes, by file, line and check."""
    found: dict[tuple[str, str, str], str] = {}
    key = None
    for line in text.splitlines(keepends=True):
        if match := FINDING.match(line.rstrip("\n")):
            name = os.path.relpath(match[1], TOP)
            key = name, match[2], match[3].removesuffix(",-warnings-as-errors")
            line = line.replace(match[1], name)
            found[key] = line
        elif key:
            found[key] += line
    return found


def main(build: pathlib.Path, wanted: list[str]) -> int:
    begin = time.monotonic()
    for name in ("clean", "together"):
        (build / name).mkdir(exist_ok=True)
    sources = sources_of(build, wanted)
    batches = batches_of(sources)
    findings: dict[tuple[str, str, str], str] = {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for text in pool.map(lambda batch: check(build, batch), batches):
            for key, finding in findings_of(text).items():
                if findings.setdefault(key, finding) is finding:
                    print(finding, end="", flush=True)
    print(f"lint.sh: {len(sources)} sources in {len(batches)} batches: {len(findings)} findings, "
          f"{time.monotonic() - begin:.0f} s")  # fmt: skip
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]))
