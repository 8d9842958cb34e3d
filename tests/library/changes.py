"""Compares the declarations of the C headers with those of the last version: CHANGES.md names each that has changed.

changes.py           prints what CHANGES.md lacks; exit code 1 if it lacks anything
changes.py --write   makes the present declarations those of the last version: for a new version
"""

from __future__ import annotations

import os
import pathlib
import re
import sys

LIBRARY = pathlib.Path(__file__).resolve().parents[2] / "haptics/library"
RECORD = LIBRARY / "interface.txt"
FIELD = re.compile(r"\(\*(\w+)\)|(\w+)(?:\[\w+\])*$")


def declarations(headers: str) -> dict[str, str]:
    """Each function, type, field, value and constant, with what a program relies on: for a field also its place."""
    text = re.sub(r"/\*.*?\*/", "", headers, flags=re.DOTALL)
    found = dict(re.findall(r"^#define (PP_[A-Z_]+) ([\w.]+)$", text, re.MULTILINE))
    text = re.sub(r"^#.*?(?<!\\)$", "", text, flags=re.MULTILINE | re.DOTALL)
    for name in re.findall(r"^PP_OPTIONS\((\w+)\)$", text, re.MULTILINE):
        found[f"pp_init_{name}"] = found[f"pp_default_{name}"] = "PP_OPTIONS"
    text = re.sub(r"^PP_OPTIONS.*$", "", re.sub(r"\bPP_API\b", "", text), flags=re.MULTILINE)
    for kind, name, body in re.findall(r"typedef (struct|enum) (\w+) \{(.*?)\} \w+;", text, re.DOTALL):
        found[name] = kind
        members = body.split(";" if kind == "struct" else ",")
        for place, member in enumerate(" ".join(each.split()) for each in members if each.strip()):
            if kind == "enum":
                found[member.partition(" = ")[0]] = member.partition(" = ")[2]
            elif field := FIELD.search(member):
                found[f"{name}.{field[1] or field[2]}"] = f"{place} {member}"
    text = re.sub(r'typedef (struct|enum) (\w+) \{(.*?)\} \w+;|extern "C" \{|\}', "", text, flags=re.DOTALL)
    for declaration in text.split(";"):
        if name := re.search(r"\b(pp_\w+)\(|\(\*(pp_\w+)\)\(", declaration):
            found[name[1] or name[2]] = " ".join(declaration.split())
    return found


def undescribed(before: dict[str, str], now: dict[str, str], page: str) -> list[str]:
    """Names that were added, removed or changed, and that the page lacks. A new type stands for its fields."""
    changed = [name for name in {**before, **now} if before.get(name) != now.get(name)]
    wholes = {name for name in changed if (name in before) != (name in now)}
    return sorted(
        name for name in changed
        if not re.search(rf"(?<![\w.]){re.escape(name)}(?!\w|\.\w)", page)
        and name.partition(".")[0] not in wholes - {name}
        and re.sub(r"^pp_(init|default)_", "pp_", name) not in wholes - {name})


def check_itself() -> None:
    header = """typedef struct pp_a {
  double x; /** mm */
} pp_a;
PP_OPTIONS(a)
PP_API int pp_f(const pp_a* a,
                int b);
"""
    known = declarations(header)
    assert known == {"pp_a": "struct", "pp_a.x": "0 double x", "pp_init_a": "PP_OPTIONS", "pp_default_a": "PP_OPTIONS",
                     "pp_f": "int pp_f(const pp_a* a, int b)"}, known
    for change, name in [(("x;", "y;"), "pp_a.y"), (("double", "float"), "pp_a.x"), (("pp_f", "pp_g"), "pp_g"),
                         (("int b", "long b"), "pp_f"), (("pp_a", "pp_c"), "pp_c"),
                         (("  double", "  int n;\n  double"), "pp_a.x")]:
        assert name in undescribed(known, declarations(header.replace(*change)), "pp_ab"), change
    assert undescribed(known, declarations(header.replace("x;", "y;")), "pp_a.x is pp_a.y") == []


def main() -> int:
    if os.environ.get("PALPATE_TESTS_ONLY"):
        print(f"changes.py: skipped: it has no label {os.environ['PALPATE_TESTS_ONLY']}")
        return 77
    check_itself()
    headers = "\n".join(file.read_text() for file in sorted((LIBRARY / "include/palpate").glob("*.h")))
    now = declarations(headers)
    if sys.argv[1:] == ["--write"]:
        RECORD.write_text("".join(f"{name}: {now[name]}\n" for name in sorted(now)))
        return 0
    before = dict(line.split(": ", 1) for line in RECORD.read_text().splitlines())
    version = ".".join(re.findall(r"define PALPATE_VERSION_\w+ (\d+)", headers))
    page = (LIBRARY / "CHANGES.md").read_text().partition(f"\n## {version}")[2].partition("\n## ")[0]
    if not page:
        print(f"CHANGES.md has no section '## {version}'")
    missing = undescribed(before, now, page)
    for name in missing:
        print(f"CHANGES.md does not say what changed: {name}: was {before.get(name)}, is {now.get(name)}")
    return 1 if missing or not page else 0


sys.exit(main())
