#!/usr/bin/env python3
"""Writes one Markdown page of all measurements: the JSON files of apps/bench/results, by name.

usage: page.py [-o PAGE.md] [FOLDER]

A file is a list of measurements, each an object: title, command (or source, where no command of palpate measures it),
columns and rows, and if known machine, date, unit, picture (a file of apps/bench) and notes. A cell [a, b] is shown as
"a / b". A file may also be what a bench wrote itself (--json): it has machines, and a table for each array of objects.
"""
import argparse
import json
import os
import pathlib
import re
import sys
from decimal import Decimal

BENCH = pathlib.Path(__file__).resolve().parent
NEEDED = {"title", "columns", "rows"}
KNOWN = NEEDED | {"command", "source", "machine", "date", "unit", "picture", "notes"}
QUANTILES = {"n", "min", "p50", "p99", "p999", "max"}


class Invalid(Exception):
    """A file that cannot be shown, with the reason."""


def cell(value):
    if value is None:
        return "–"
    if isinstance(value, list):
        return (", " if any(isinstance(v, list) for v in value) else " / ").join(map(cell, value))
    if isinstance(value, Decimal):
        if len(value.as_tuple().digits) <= 4:
            return f"{value:,f}"
        return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"  # a bench writes more digits than it knows
    if isinstance(value, int) and not isinstance(value, bool):
        return f"{value:,}"
    return str(value).replace("|", "\\|")


def table(columns, rows):
    lines = [columns, ["---"] * len(columns), *([cell(v) for v in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def flattened(value, path=""):
    """The cells of an object, by dotted key, and its arrays of objects. Quantiles become [median, p99.9]."""
    cells, arrays = {}, {}
    for key, entry in value.items():
        name = f"{path}{key}"
        if isinstance(entry, dict) and {"p50", "p999"} <= entry.keys() <= QUANTILES:
            cells[name] = [entry["p50"], entry["p999"]]
        elif isinstance(entry, dict):
            inner = flattened(entry, f"{name}.")
            cells |= inner[0]
            arrays |= inner[1]
        elif isinstance(entry, list) and entry and all(isinstance(row, dict) for row in entry):
            arrays[name] = entry
        elif not isinstance(entry, list) or 0 < len(entry) <= 4:  # longer ones are curves, for a plot
            cells[name] = entry
    return cells, arrays


def bench_tables(name, rows):
    """A table of the rows, and one of each array in them, whose rows begin with the texts of the row they are in."""
    found, inner = [], {}
    for row, names in rows:
        cells, arrays = flattened(row)
        found.append(names | cells)
        names = names | {key: text for key, text in cells.items() if isinstance(text, str)}
        for key, entries in arrays.items():
            inner.setdefault(key, []).extend((entry, names) for entry in entries)
    if columns := list(dict.fromkeys(key for row in found for key in row)):
        yield f"`{name}`\n\n" + table(columns, [[row.get(key) for key in columns] for row in found])
    for key, entries in inner.items():
        yield from bench_tables(f"{name}.{key}", entries)


def from_bench(file, result):
    """What a bench wrote with --json; `run` (command, date and version) may be missing."""
    about = {"command": [], "title": f"{file.stem.replace('_', ' ')} (written by the bench)", "unit": "median / p99.9"}
    run = result.get("run", {})
    about |= {key: run[key] for key in ("command", "date") if key in run}
    about["machine"] = ", ".join(f"{backend}: {text}" for backend, text in result["machines"].items())
    if "version" in run:
        about["machine"] += f", palpate {run['version']}"
    tables = [text for key, value in result.items()
              if key not in ("run", "machines") and isinstance(value, (list, dict))
              for text in bench_tables(key, [(row, {}) for row in (value if isinstance(value, list) else [value])])]
    if not tables:
        raise Invalid("has machines, but no measurement")
    return about, "\n\n".join(tables)


def by_hand(entry, number):
    where = f"measurement {number} ({entry.get('title', 'no title')})"
    missing = sorted(NEEDED - entry.keys()) + ["command"] * (not entry.keys() & {"command", "source"})
    if missing:
        raise Invalid(f"{where} lacks {', '.join(missing)}")
    if unknown := sorted(entry.keys() - KNOWN):
        raise Invalid(f"{where} has unknown keys: {', '.join(unknown)}")
    for count, row in enumerate(entry["rows"], 1):
        if len(row) != len(entry["columns"]):
            raise Invalid(f"{where}: row {count} has {len(row)} cells for {len(entry['columns'])} columns")
    if "picture" in entry and not (BENCH / entry["picture"]).is_file():
        raise Invalid(f"{where}: no picture {entry['picture']}")
    return entry, table(entry["columns"], entry["rows"])


def measurements(file):
    try:
        content = json.loads(file.read_text(encoding="utf-8"), parse_float=Decimal)
    except ValueError as error:
        raise Invalid(f"is not valid JSON: {error}") from error
    if isinstance(content, dict) and "machines" in content:
        return [from_bench(file, content)]
    if not isinstance(content, list):
        raise Invalid("is neither a list of measurements nor the result of a bench, which has the key 'machines'")
    return [by_hand(entry, number) for number, entry in enumerate(content, 1)]


def section(about, tables, folder):
    commands = about.get("command", [])
    commands = "\n".join([commands] if isinstance(commands, str) else commands)
    facts = "; ".join(about[key] for key in ("machine", "date", "unit") if key in about)
    parts = [f"## {about['title']}", f"```\n{commands}\n```" if commands else about.get("source", ""), facts, tables]
    if "picture" in about:
        parts.append(f"![{about['title']}]({os.path.relpath(BENCH / about['picture'], folder)})")
    return "\n\n".join(filter(None, [*parts, "\n".join(f"- {note}" for note in about.get("notes", []))]))


def page(results, folder):
    found = []
    for file in sorted(results.glob("*.json")):
        try:
            found += measurements(file)
        except Invalid as reason:
            sys.exit(f"{file}: {reason}")
        except (AttributeError, KeyError, TypeError) as reason:
            sys.exit(f"{file}: a value has the wrong kind: {reason}")
    contents = [f"- [{about['title']}](#{re.sub(r'[^a-z0-9 _-]', '', about['title'].lower()).replace(' ', '-')})"
                for about, _ in found]
    return "\n\n".join(["# Measurements", "\n".join(contents), *(section(*each, folder) for each in found)]) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Writes one Markdown page of all measurements.")
    parser.add_argument("-o", dest="output", type=pathlib.Path, default=pathlib.Path("measurements.md"))
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=BENCH / "results")
    asked = parser.parse_args()
    asked.output.write_text(page(asked.folder, asked.output.resolve().parent), encoding="utf-8")
