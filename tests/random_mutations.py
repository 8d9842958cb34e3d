#!/usr/bin/env python3
"""Judges a change of the tests: makes random bugs in source lines that two trees share, and names each bug that the
quick tests of OLD detect and those of NEW do not.

  python3 tests/random_mutations.py OLD NEW [--count 30] [--seed HEX] [--only N,N,...]

OLD and NEW are source trees (git worktrees without uncommitted changes) with a build of the preset `release`. The
seed is the first eight hexadecimal digits of OLD's commit, unless --seed says otherwise. A bug is made in NEW first;
one that survives there is made in OLD too. A room's bug is judged by the test programs of that room. Both trees are
restored and built again at the end. The exit code is 1 if a bug is detected in OLD alone.
"""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

LIMIT_S = 300  # of one test program; a bug that makes it hang counts as detected
FOLDERS = ("engine/", "haptics/", "shaders/", "apps/")
ENDINGS = (".cpp", ".hpp", ".h", ".comp", ".glsl")
NOT_JUDGED = re.compile(r"_windows\.|engine/cuda/|/no_|not_built|apps/examples|apps/bench|haptics/devices/hdapi_")

# (pattern, replacement): each a mistake that a compiler accepts.
MISTAKES = [(re.compile(pattern), replacement) for pattern, replacement in (
    (r" < ", " <= "), (r" <= ", " < "), (r" > ", " >= "), (r" >= ", " > "), (r" == ", " != "), (r" != ", " == "),
    (r" && ", " || "), (r" \|\| ", " && "), (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" \+= ", " -= "),
    (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min"), (r"\bmin\(", "max("), (r"\bmax\(", "min("),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"), (r"\b1\b", "2"), (r"\b0\.5\b", "0.25"), (r"!(?=[a-z(])", ""),
    (r"\breturn;", ";"), (r"\+\+", "--"), (r"\bbarrier\(\);", ";"),
    (r"^(\s+)[a-z]\w*(?:[.]\w+|->\w+)*\(.*\);$", r"\1;"),
)]


def run(words, folder, limit_s=1800, **surroundings):
    """Output and exit code; 124 if the limit was reached, and the whole group of processes is ended."""
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", env={**os.environ, **surroundings}, start_new_session=True)
    try:
        return process.communicate(timeout=limit_s)[0], process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return process.communicate()[0], 124


def git(tree, *words):
    return subprocess.run(["git", "-C", tree, *words], check=True, capture_output=True, text=True).stdout


def rooms_of(file):
    """Names of the test programs, without `tests_`, that judge a source file."""
    parts = file.split("/")
    if file.startswith("shaders/shared/") or file.startswith("shaders/lib/"):
        return ["core", "contact", "edit", "touch", "contact_gpu", "edit_gpu", "touch_gpu", "render", "matter_gpu"]
    if parts[0] in ("engine", "shaders"):
        return {"cloud": ["cloud", "io"], "gpu": ["gpu", "spatial_gpu"]}.get(parts[1], [parts[1], parts[1] + "_gpu"])
    if parts[0] == "apps":
        return ["apps"]
    room = parts[1] if parts[1] in ("session", "library", "sharing", "simulation", "study") else "haptics"
    return [room, room + "_gpu"]


class Tree:
    def __init__(self, folder):
        self.folder = str(Path(folder).resolve())
        self.built = Path(self.folder) / "build/release"
        if git(self.folder, "status", "--porcelain", "--untracked-files=no"):
            sys.exit(f"random_mutations.py: {folder} has uncommitted changes")
        if not (self.built / "build.ninja").exists():
            sys.exit(f"random_mutations.py: {folder} has no build of the preset release")
        self.targets = set(re.findall(r"^build (tests_\w+): ", (self.built / "build.ninja").read_text(), re.M))
        self.touched = set()

    def lines(self, file):
        return (Path(self.folder) / file).read_text().split("\n")

    def build(self, targets):
        return run(["cmake", "--build", "--preset", "release", "--target", *targets], self.folder)[1] == 0

    def restore(self):
        git(self.folder, "checkout", "-q", "-f")

    def judge(self, file, number, line):
        """"no build", "survived", or the program and the first case that failed."""
        targets = [f"tests_{room}" for room in rooms_of(file) if f"tests_{room}" in self.targets]
        if file.startswith("apps/python/"):
            targets = ["palpate_python"]
        mutated = self.lines(file)
        mutated[number] = line
        (Path(self.folder) / file).write_text("\n".join(mutated))
        self.touched.update(targets)
        try:
            if not self.build(targets):
                return "no build"
            for target in targets:
                failure = self.failure(target, file)
                if failure:
                    return failure
            return "survived"
        finally:
            self.restore()

    def failure(self, target, file):
        """The first failing case of a test program, run as ctest runs it; empty if all pass."""
        room = target.removeprefix("tests_").removeprefix("palpate_")
        entries = rf"^{room}\."
        if room == "apps":  # the window has tests of its own
            entries = r"^apps\.(view|measure)" if "/view/" in file else r"^apps\.[^v]"
        out, code = run(["ctest", "--preset", "release", "-R", entries, "-LE", "links", "--stop-on-failure",
                         "--output-on-failure", "-j", str(2 * os.cpu_count()), "--timeout", str(LIMIT_S)],
                        self.folder, 4 * LIMIT_S, PALPATE_GPU=os.environ.get("PALPATE_GPU", "llvmpipe"),
                        PALPATE_TESTS_VALIDATE="core")
        if code == 0:
            return ""
        case = re.search(r"^TEST CASE:\s+(.*)$", out, re.M)
        entry = re.search(r"- (\S+) \((?:Failed|Timeout|SEGFAULT|Subprocess aborted|ILLEGAL|Child aborted)", out)
        return f"{entry.group(1) if entry else target}: {case.group(1).strip() if case else 'failed'}"


def candidates(old, new):
    """(file, number in old, number in new, mutated line) of lines that stand once in both files."""
    found = []
    files = set(git(new.folder, "ls-files").split()) & set(git(old.folder, "ls-files").split())
    for file in sorted(files):
        if not file.startswith(FOLDERS) or not file.endswith(ENDINGS) or NOT_JUDGED.search(file):
            continue
        if not any(f"tests_{room}" in new.targets for room in rooms_of(file)):
            continue
        before, after = old.lines(file), new.lines(file)
        for number, line in enumerate(after):
            code = line.split("//")[0]
            text = line.strip()
            if after.count(line) != 1 or before.count(line) != 1 or '"' in line or not text:
                continue
            if text.startswith(("//", "*", "/*", "#", "static_assert", "template", "using", "friend", "case")):
                continue
            for pattern, replacement in MISTAKES:
                for place in pattern.finditer(code):
                    changed = code[: place.start()] + place.expand(replacement) + code[place.end() :]
                    found.append((file, before.index(line), number, changed + line[len(code) :]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW")
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--seed", help="hexadecimal; default: the first eight digits of OLD's commit")
    parser.add_argument("--only", help="numbers of bugs, from 1; the others are drawn but not judged")
    options = parser.parse_args()
    old, new = Tree(options.old), Tree(options.new)
    seed = options.seed or git(old.folder, "rev-parse", "HEAD")[:8]
    only = {int(number) for number in options.only.split(",")} if options.only else None
    drawn = candidates(old, new)
    random.Random(int(seed, 16)).shuffle(drawn)
    print(f"random_mutations.py: seed {seed}, {len(drawn)} possible bugs", flush=True)
    rows, judged, worse, used = [], 0, 0, set()
    try:
        for file, there, here, line in drawn:
            if judged == options.count:
                break
            if (file, here) in used:
                continue
            used.add((file, here))
            skips = only is not None and judged + 1 not in only
            begin = time.monotonic()
            after = "not judged" if skips else new.judge(file, here, line)
            if after == "no build":
                continue  # a compiler detects it
            judged += 1
            before = "" if after != "survived" else old.judge(file, there, line)
            if before and before != "survived":
                worse += 1
            was = new.lines(file)[here].strip()
            rows.append(f"| {judged} | `{file}:{here + 1}` | `{was}` → `{line.strip()}` | {after} | {before} |")
            print(f"{judged:3} {time.monotonic() - begin:5.0f} s  {file}:{here + 1}  {line.strip()}  [{after}]"
                  f"{'  OLD: ' + before if before else ''}", flush=True)
    finally:
        for tree in (old, new):
            tree.restore()
            if tree.touched and not tree.build(sorted(tree.touched)):
                print(f"random_mutations.py: {tree.folder} contains mutated programs", file=sys.stderr)
    print("\n| Nr | Line | Bug | NEW | OLD, if it survives in NEW |\n|---|---|---|---|---|\n" + "\n".join(rows))
    survived = sum("| survived |" in row for row in rows)
    print(f"random_mutations.py: {judged} bugs, {survived} survived in NEW, {worse} of them were detected in OLD")
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
