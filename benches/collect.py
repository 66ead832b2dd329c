"""JSON lines of benches to one file of a run: benches/runs/<date>-<commit>.json.

    benches/collect.py LINES...
"""

import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

RUNS = pathlib.Path(__file__).parent / "runs"


def main():
    lines = [json.loads(line) for name in sys.argv[1:] for line in pathlib.Path(name).read_text().splitlines()]
    run = about() | {"rows": rows(lines), "values": values(lines)}
    place = RUNS / f"{run['date']}-{run['commit']}.json"
    place.write_text(dump(run))
    print(place)


def about():
    dirty = told("git", "status", "--porcelain", "--", "crates")
    return {
        "date": datetime.date.today().isoformat(),
        "commit": told("git", "rev-parse", "--short", "HEAD") + ("-changed" if dirty else ""),
        "machine": {"processor": processor(), "cores": os.cpu_count(), "system": platform.system()},
        "compiler": told("rustc", "--version"),
    }


def rows(lines):
    """Rounds of the same row, one behind the other."""
    merged = {}
    for line in lines:
        if "cpu_ns" in line:
            row = merged.setdefault((line["bench"], line["name"], line["unit"]), line | {"cpu_ns": [], "wall_ns": []})
            row["cpu_ns"] += [round(ns, 4) for ns in line["cpu_ns"]]
            row["wall_ns"] += [round(ns, 4) for ns in line["wall_ns"]]
    return list(merged.values())


def values(lines):
    """The last of each: every round tells the same."""
    return list({(line["bench"], line["name"]): line for line in lines if "value" in line}.values())


def dump(run):
    """A row a line."""
    lists = {key: run.pop(key) for key in ("rows", "values")}
    text = json.dumps(run, indent=1)[:-2]
    for key, entries in lists.items():
        text += f',\n "{key}": [\n' + ",\n".join("  " + json.dumps(entry) for entry in entries) + "\n ]"
    return text + "\n}\n"


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.processor()


def told(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=RUNS).stdout.strip()


if __name__ == "__main__":
    main()
