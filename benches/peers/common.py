"""Arrays as `occlabel-suite export` writes them, a CPU clock, and rows as it prints them."""

import json
import sys
import time

import numpy as np

FOLDER = sys.argv[1]


def array(name, kind, *shape):
    return np.fromfile(f"{FOLDER}/{name}", dtype=kind).reshape(shape or (-1,))


def keyframe():
    with open(f"{FOLDER}/keyframe.json") as file:
        return json.load(file)


def measure(name, unit, count, work):
    """What `work` costs a unit, as a row; its result is returned."""
    cpu, wall = time.process_time(), time.perf_counter()
    result = work()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    row = {"bench": "peers", "name": name, "unit": unit, "count": count}
    print(json.dumps(row | {"cpu_ns": [cpu / count * 1e9], "wall_ns": [wall / count * 1e9]}))
    return result


def tell(name, unit, value):
    print(json.dumps({"bench": "peers", "name": name, "unit": unit, "value": float(value)}))
