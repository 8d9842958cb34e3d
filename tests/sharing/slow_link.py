#!/usr/bin/env python3
"""Two network namespaces with one link between them that delays, loses, reorders and can be cut.

slow_link.py NAME_A NAME_B ROUND_TRIP_MS LOSS_PERCENT CUT_FILE [JITTER_MS]: makes the namespaces NAME_A (10.77.0.1,
interface a) and NAME_B (10.77.0.2, interface b), prints "up", and passes frames from one to the other until it is told
to end. Each frame comes half a round trip later, plus up to the jitter, so that frames overtake each other. While
CUT_FILE exists no frame passes. A generator of fixed seed chooses the lost frames, the same ones each time. Requires
root's rights over the network.
"""
import collections
import fcntl
import heapq
import os
import random
import select
import signal
import struct
import subprocess
import sys
import time

TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000


def run(*words):
    subprocess.run(words, check=True)


def tap(name, namespace, address):
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH", name.encode(), IFF_TAP | IFF_NO_PI))
    run("ip", "netns", "add", namespace)
    run("ip", "link", "set", "dev", name, "netns", namespace)  # this process still receives its frames
    run("ip", "-n", namespace, "addr", "add", address, "dev", name)
    run("ip", "-n", namespace, "link", "set", "lo", "up")
    run("ip", "-n", namespace, "link", "set", "dev", name, "up")
    return device


def main():
    space_a, space_b, round_trip_ms, loss_percent, cut_file, *rest = sys.argv[1:]
    jitter_s = float(rest[0]) / 1000 if rest else 0.0
    delay_s, loss = float(round_trip_ms) / 2000, float(loss_percent) / 100
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    chance = random.Random(7)
    counts = collections.Counter()
    try:
        a = tap("a", space_a, "10.77.0.1/24")
        b = tap("b", space_b, "10.77.0.2/24")
        print("up", flush=True)
        waiting, came, left_last = [], 0, 0  # sorted by departure time, then by arrival order
        while True:
            left = max(0.0, waiting[0][0] - time.monotonic()) if waiting else 0.2
            for device in select.select([a, b], [], [], left)[0]:
                while True:
                    try:
                        frame = os.read(device, 65536)
                    except BlockingIOError:
                        break
                    counts["frames"] += 1
                    if chance.random() < loss or os.path.exists(cut_file):
                        counts["lost"] += 1
                    else:
                        leaves = time.monotonic() + delay_s + (jitter_s * chance.random() if jitter_s else 0.0)
                        came += 1
                        heapq.heappush(waiting, (leaves, came, b if device == a else a, frame))
            while waiting and waiting[0][0] <= time.monotonic():
                _, number, device, frame = heapq.heappop(waiting)
                counts["overtaken"] += number < left_last
                left_last = max(left_last, number)
                try:
                    os.write(device, frame)
                except OSError:
                    counts["lost"] += 1
    finally:
        print(f"{counts['frames']} frames, {counts['lost']} lost, {counts['overtaken']} overtaken", flush=True)
        for space in (space_a, space_b):
            subprocess.run(["ip", "netns", "del", space], stderr=subprocess.DEVNULL, check=False)


main()
