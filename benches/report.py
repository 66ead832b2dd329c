"""A run as tables in docs/performance.md and as a plot beside it.

    benches/report.py benches/runs/RUN.json
"""

import json
import pathlib
import re
import statistics
import sys

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.fonttype"] = "none"
matplotlib.rcParams["svg.hashsalt"] = "occlabel"
import matplotlib.pyplot as plt

DOCS = pathlib.Path(__file__).parent.parent / "docs"
BEGIN, END = "<!-- run: begin -->", "<!-- run: end -->"
JOBS = [
    ("rays", "Rays into the grid of one keyframe"),
    ("neighbours", "Five neighbours of a point"),
    ("keyframe", "A whole keyframe from labelled points"),
]


def main():
    run = json.loads(pathlib.Path(sys.argv[1]).read_text())
    page = DOCS / "performance.md"
    before, rest = page.read_text().split(BEGIN)
    after = rest.split(END)[1]
    page.write_text(before + BEGIN + "\n" + tables(run) + END + after)
    plot(run, DOCS / "performance.svg")


def tables(run):
    machine = run["machine"]
    head = f"Commit {run['commit']}, {run['date']}, {machine['processor']}, {machine['cores']} cores, {run['compiler']}.\n"
    parts = [head, stages(run), lidar(run), scaling(run), scenes(run)]
    parts += [peers(run, job, title) for job, title in JOBS if ours(run, job)]
    return "\n".join(parts + [whole_scene(run)])


def stages(run):
    lines = ["| Stages | a unit is a | CPU ns a unit | least to most |", "|---|---|---|---|"]
    for row in of(run, "stages"):
        lines.append(f"| {row['name']} | {row['unit']} | {number(middle(row))} | {spread(row)} |")
    return "\n".join(lines) + "\n"


def lidar(run):
    """The kernels on each instruction set, beside the walk of one ray after the other."""
    lines = ["| Lidar pass | CPU ns a ray | CPU ns a voxel visit | least to most | visits: the scalar walk to it |", "|---|---|---|---|---|"]
    visits = [row for row in of(run, "lidar") if row["unit"] == "voxel visit"]
    for row in visits:
        ray = find(run, "lidar", row["name"])
        times = statistics.median(a / b for a, b in zip(visits[0]["cpu_ns"], row["cpu_ns"]))
        lines.append(f"| {row['name']} | {number(middle(ray))} | {number(middle(row))} | {spread(row)} | {times:.2f} |")
    return "\n".join(lines) + "\n"


def scaling(run):
    """Each row beside the one before of its kind: names that differ in numbers alone."""
    lines = ["| Scaling | a unit is a | CPU ns a unit | least to most | units, to the row before | CPU, to the row before |", "|---|---|---|---|---|---|"]
    before = {}
    for row in of(run, "scaling"):
        kind = re.sub(r"[0-9.]+", "#", row["name"])
        growth = grown(before[kind], row) if kind in before else " | "
        before[kind] = row
        lines.append(f"| {row['name']} | {row['unit']} | {number(middle(row))} | {spread(row)} | {growth} |")
    return "\n".join(lines) + "\n"


def grown(before, row):
    cpu = statistics.median(b / a for a, b in zip(before["cpu_ns"], row["cpu_ns"]))
    units = row["count"] / before["count"]
    return f"{units:.2f} | {cpu * units:.2f}"


def scenes(run):
    """Runs of `label` on one thread and on two."""
    lines = ["| `label` | CPU ns a ray | least to most | CPU, 2 threads to 1 | wall, 1 thread to 2, best | peak MiB |", "|---|---|---|---|---|---|"]
    for row in of(run, "scene"):
        if not row["name"].endswith(", 1 threads"):
            continue
        name = row["name"].removesuffix(", 1 threads")
        two = find(run, "scene", f"{name}, 2 threads")
        cpu = statistics.median(b / a for a, b in zip(row["cpu_ns"], two["cpu_ns"]))
        wall = max(a / b for a, b in zip(row["wall_ns"], two["wall_ns"]))
        peak = value(run, f"{name}, peak memory")
        lines.append(f"| {name} | {number(middle(row))} | {spread(row)} | {cpu:.2f} | {wall:.2f} | {peak:.0f} |")
    return "\n".join(lines) + "\n"


def peers(run, job, title):
    lines = [f"| {title} | a unit is a | CPU ns a unit | least to most | times ours | came out |", "|---|---|---|---|---|---|"]
    for row in peer_rows(run, job):
        times = f"{ratio(run, job, row):.1f}" if comparable(run, job, row) else ""
        lines.append(f"| {short(row)} | {row['unit']} | {number(middle(row))} | {spread(row)} | {times} | {outcome(run, row)} |")
    return "\n".join(lines) + "\n"


def whole_scene(run):
    """Everything that the scripts of numba, NumPy and scikit-learn do for a scene, against `label`."""
    label = find(run, "scene", "nuscenes_like, precise, 1 threads")
    queries = find(run, "stages", "relabel")["count"]
    keyframes = value(run, "nuscenes_like, keyframes")
    index, search = (find(run, "peers", f"neighbours, scikit-learn{part}") for part in (": index", ""))
    script = keyframes * total(find(run, "peers", "keyframe, numba + NumPy")) + total(index) + queries * middle(search)
    return (
        f"A whole scene: numba, NumPy and scikit-learn, {keyframes:.0f} keyframes and the neighbours of "
        f"{queries / 1e6:.1f} million points added up, without boxes and without reading and writing files, "
        f"take {script / total(label):.1f} times the CPU time of `label` with all that.\n"
    )


def total(row):
    return middle(row) * row["count"]


def ratio(run, job, row):
    """The median over rounds, each against our own time of the same round."""
    return statistics.median(b / a for a, b in zip(ours(run, job)["cpu_ns"], row["cpu_ns"]))


def comparable(run, job, row):
    return row["unit"] == ours(run, job)["unit"]


def outcome(run, row):
    """What it told of its result, beside the row."""
    told = [v for v in run["values"] if v["name"].startswith(row["name"] + ": ")]
    return ", ".join(f"{v['name'].split(': ')[1]} {v['value']:.6g}" for v in told)


def peer_rows(run, job):
    return [row for row in of(run, "peers") if row["name"].startswith(f"{job}, ")]


def ours(run, job):
    return find(run, "peers", f"{job}, ours")


def find(run, bench, name):
    return next((row for row in of(run, bench) if row["name"] == name), None)


def value(run, name):
    return next(v["value"] for v in run["values"] if v["name"] == name)


def of(run, bench):
    return [row for row in run["rows"] if row["bench"] == bench]


def short(row):
    return row["name"].split(", ", 1)[1]


def middle(row):
    return statistics.median(row["cpu_ns"])


def spread(row):
    return f"{number(min(row['cpu_ns']))} to {number(max(row['cpu_ns']))}"


def number(x):
    return f"{x:.3g}" if x < 1000 else f"{x:,.0f}".replace(",", " ")


def plot(run, place):
    """How many times our CPU time the others take, on a logarithmic axis."""
    jobs = [(job, title) for job, title in JOBS if ours(run, job)]
    heights = [len(bars(run, job)) for job, _ in jobs]
    figure, axes = plt.subplots(len(jobs), 1, figsize=(8, 1.1 + 0.5 * sum(heights)), height_ratios=heights, sharex=True)
    for axis, (job, title) in zip(axes, jobs):
        names, ratios = zip(*bars(run, job))
        axis.barh(names, ratios, color=["#20639b" if name == "ours" else "#9aa5b1" for name in names])
        axis.set_xscale("log")
        axis.set_title(title, loc="left", fontsize=10)
        axis.invert_yaxis()
        for at, x in enumerate(ratios):
            axis.text(x * 1.05, at, f"{x:.1f}", va="center", fontsize=9)
    axes[-1].set_xlabel("CPU time, ours = 1")
    shown = [x for job, _ in jobs for _, x in bars(run, job)]
    axes[-1].set_xlim(0.7 * min(shown), 2 * max(shown))
    figure.tight_layout()
    figure.savefig(place, metadata={"Date": None})


def bars(run, job):
    rows = [row for row in peer_rows(run, job) if comparable(run, job, row)]
    return [(short(row), ratio(run, job, row)) for row in rows]


if __name__ == "__main__":
    main()
