#!/usr/bin/env python3
"""What a hand at the end of a bad link feels, as a table in Markdown.

link_table.py PALPATE [--short] [ROUND_TRIP_MS,LOSS_PERCENT[,JITTER_MS]...]: serves a sculpture in one network namespace
and joins it in another one, over a link that delays and loses packets (slow_link.py). Prints for each link: whether the
trace of a hand is byte by byte that of the file; how long it takes until a press is felt by another hand (palpate bench
share, both hands at the far end, so that a round trip is included); the energy that a yielding hand received and that
neither hand put in, while the other hand, beside the server, raises the surface under it; and how many ticks were
missed, or had less force because the last update was old. With --short each link is measured briefly, and the script
fails if a bound is exceeded. Exit code 77, with the reason, if this machine cannot make such a link.
"""
import contextlib
import csv
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

DELAYS_MS, LOSSES = (0, 20, 100, 300, 1000), (0, 1, 5)
MOST_BEYOND_MS, LEAST_ENERGY_MJ = 20, -1
HERE = pathlib.Path(__file__).resolve().parent


def skip(why):
    print(f"link_table: skipped: {why}")
    sys.exit(77)


class Cell:
    """A link, a server at its far end, and programs at either end."""

    def __init__(self, palpate, folder, trip_ms, loss, jitter_ms):
        self.palpate, self.folder, self.trip_s = palpate, folder, trip_ms / 1000
        self.spaces = {end: f"pp_{end}_{os.getpid()}" for end in ("near", "far")}
        self.interfaces = {"near": "a", "far": "b"}
        self.running = []
        self.link = subprocess.Popen(
            [sys.executable, HERE / "slow_link.py", self.spaces["near"], self.spaces["far"], str(trip_ms), str(loss),
             folder / "cut", str(jitter_ms)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        said = self.link.stdout.readline()
        if said.strip() != "up":
            skip(said + self.link.stdout.read())

    def start(self, end, *words, said):
        log = open(self.folder / said, "w", encoding="utf-8")
        process = subprocess.Popen(
            ["ip", "netns", "exec", self.spaces[end], self.palpate, *words, "--interface", self.interfaces[end]],
            stdout=log, stderr=log)
        self.running.append(process)
        return process

    def wait_for(self, said, words, process):
        while not re.search(words, (self.folder / said).read_text(encoding="utf-8"), re.MULTILINE):
            if process.poll() is not None:
                raise RuntimeError(f"{said}: {(self.folder / said).read_text(encoding='utf-8')}")
            time.sleep(0.02)

    def run(self, end, *words, said):
        process = self.start(end, *words, said=said)
        if process.wait() != 0:
            raise RuntimeError(f"{words}: {(self.folder / said).read_text(encoding='utf-8')}")

    def serve(self):
        server = self.start("far", "serve", self.folder / "model.ply", "--name", "far", said="serve.log")
        self.wait_for("serve.log", "serving", server)
        return server

    def close(self):
        for process in self.running:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in self.running:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(5)
            if process.poll() is None:
                process.kill()
        self.link.terminate()
        return self.link.communicate()[0].strip()  # counts of lost and overtaken frames


def worst_difference_N(first, second):
    """Largest difference between the forces of two traces; infinite if their ticks differ."""
    with open(first, encoding="utf-8") as a, open(second, encoding="utf-8") as b:
        rows = list(csv.DictReader(a)), list(csv.DictReader(b))
    if len(rows[0]) != len(rows[1]):
        return math.inf
    return max(math.dist(*[[float(row[f"force_{axis}"]) for axis in "xyz"] for row in pair]) for pair in zip(*rows))


def measure(palpate, folder, trip_ms, loss, jitter_ms, presses, duration_s):
    cell = Cell(palpate, folder, trip_ms, loss, jitter_ms)
    try:
        server = cell.serve()
        cell.run("near", "--quiet", "touch", "--join", "far", "--backend", "cpu", "--duration", "1", "--trace",
                 folder / "joined.csv", said="touch.log")
        bench = cell.start("near", "--quiet", "bench", "share", "--join", "far", "--presses", str(presses), "--json",
                           folder / "bench.json", said="bench.log")
        if bench.wait() != 0:
            raise RuntimeError((folder / "bench.log").read_text(encoding="utf-8"))
        server.send_signal(signal.SIGINT)
        server.wait()
        cell.serve()  # without the dents
        # The hand starts before the other one, and ends after it, however long that takes to start.
        hand = cell.start("near", "touch", "--join", "far", "--backend", "cpu", "--device", "sim", "--realtime",
                          "--duration", "60", "--json", folder / "hand.json", said="hand.log")
        cell.wait_for("hand.log", r"^touch: [1-9]", hand)
        cell.run("far", "touch", "--join", "far", "--backend", "cpu", "--realtime", "--edit", "inflate", "--strength",
                 "0.1", "--duration", str(duration_s + 4 * cell.trip_s), said="other.log")
        time.sleep(1 + 2 * cell.trip_s)  # the last edits are in flight
        hand.send_signal(signal.SIGINT)
        code, said = hand.wait(), (folder / "hand.log").read_text(encoding="utf-8")
        if code != 128 + signal.SIGINT or "interrupted after" not in said:
            raise RuntimeError(said)
    finally:
        frames = cell.close()
    with open(folder / "bench.json", encoding="utf-8") as file:
        share = json.load(file)["share"][0]
    with open(folder / "hand.json", encoding="utf-8") as file:
        hand = json.load(file)
    return {"trip_ms": trip_ms, "loss": loss, "jitter_ms": jitter_ms, "frames": frames, "share": share, "hand": hand,
            "same": (folder / "joined.csv").read_bytes() == (folder / "own.csv").read_bytes(),
            "worst_N": worst_difference_N(folder / "joined.csv", folder / "own.csv")}


def line(cell):
    share, hand = cell["share"], cell["hand"]
    pair = lambda summary: f"{summary['p50']:.0f} / {summary['p99']:.0f}" if summary else "none"
    ticks = share["ticks"] + share["missed_ticks"] + hand["ticks"] + hand["missed_ticks"]
    same = "byte by byte" if cell["same"] else f"differs, {cell['worst_N']:.3g} N"
    return (f"| {cell['trip_ms']} | {cell['loss']} | {same} | {pair(share['felt_ms'])} | {pair(share['beyond_ms'])} | "
            f"{(share['felt_ms'] or {'n': 0})['n']}, {share['not_felt']} | {share['dropped_edits']} | "
            f"{share['missed_ticks'] + hand['missed_ticks']} of {ticks} | "
            f"{share['aged_ticks'] + hand['safety']['aged_ticks']} | {hand['shared']['oldest_s']:.1f} | "
            f"{hand['passivity_energy_mJ']:.3f} |")


def complaints(cell):
    share, hand = cell["share"], cell["hand"]
    if not cell["same"]:
        yield f"the trace is not the file's; forces differ by up to {cell['worst_N']} N"
    if cell["jitter_ms"] and ", 0 overtaken" in cell["frames"]:
        yield "no frame has overtaken another one"
    if share["not_felt"] or not share["felt_ms"]:
        yield f"{share['not_felt']} presses were not felt"
    elif share["beyond_ms"]["p50"] > MOST_BEYOND_MS:
        yield f"a press is felt {share['beyond_ms']['p50']:.1f} ms after the round trip"
    if hand["passivity_energy_mJ"] < LEAST_ENERGY_MJ:
        yield f"a hand was given {-hand['passivity_energy_mJ']} mJ"
    if share["aged_ticks"] + hand["safety"]["aged_ticks"] > 0:
        yield "a force faded over a link that was never silent for long"
    if hand["contact_ticks"] == 0:
        yield "the hand that yields has touched nothing"
    if hand["shared"]["received"] == 0:
        yield "nothing of what the other hand did has come"
    if not hand["shared"]["same"]:
        yield "the hand has other points than the server in the end"


def main():
    palpate, short = pathlib.Path(sys.argv[1]).resolve(), "--short" in sys.argv[2:]
    if os.geteuid() != 0:
        skip("only root makes network namespaces")
    if not shutil.which("ip"):
        skip("there is no ip (iproute2)")
    if not os.access("/dev/net/tun", os.W_OK):
        skip("there is no /dev/net/tun")
    named = [tuple(int(number) for number in word.split(",")) for word in sys.argv[2:] if word != "--short"]
    cells = named or [(delay, loss) for delay in DELAYS_MS for loss in LOSSES]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # ends the programs that it has started
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        quietly = [palpate, "--quiet"]
        points = "5000" if short else "20000"
        subprocess.run([*quietly, "make", "sculpture", "-n", points, "-o", folder / "model.ply"], check=True)
        subprocess.run([*quietly, "touch", folder / "model.ply", "--backend", "cpu", "--duration", "1", "--trace",
                        folder / "own.csv"], check=True, stdout=subprocess.DEVNULL)
        print("| round trip, ms | lost, % | trace of a hand, 1 s | a press felt by another hand, ms "
              "| beyond the round trip, ms | felt, not felt | ticks that put an edit off | ticks missed "
              "| ticks with less force | oldest, s | least energy, mJ |")
        print("|---|---|---|---|---|---|---|---|---|---|---|", flush=True)
        for trip_ms, loss, *jitter_ms in cells:
            presses = 6 if short else 60 if trip_ms < 1000 else 30
            cell = measure(palpate, folder, trip_ms, loss, *(jitter_ms or [0]), presses, 1 if short else 10)
            print(line(cell), flush=True)
            if jitter_ms:
                print(f"link_table: a jitter of {jitter_ms[0]} ms: {cell['frames']}", flush=True)
            for complaint in complaints(cell) if short else ():
                print(f"link_table: {complaint}", file=sys.stderr)
                failed = True
    sys.exit(1 if failed else 0)


main()
