"""RayIoU and its kin as short NumPy statements, and small inputs with what they give.

    python3 rays.py > rays.json

Slow on purpose. Floats are printed so that they read back exactly. Needs NumPy only.
"""
import json
import math

import numpy as np

NAN = float("nan")


def pitches():
    """Ten steep ones with tangents 1, 1/2, ... 1/10, then on by the last difference."""
    p = [-(math.pi / 2 - math.atan(k)) for k in range(1, 11)]
    while p[-1] < 0.21:
        p.append(p[-1] + (p[-1] - p[-2]))
    return np.array(p)


def directions(pitch, azimuth):
    """All pairs, the azimuths of the first pitch first."""
    p, a = np.meshgrid(pitch, azimuth, indexing="ij")
    xyz = [np.cos(p) * np.cos(a), np.cos(p) * np.sin(a), np.sin(p)]
    return np.stack(xyz, axis=-1).reshape(-1, 3)


def choose(origins):
    """Those within 39 m along x and y; of more than 8, 8 from the first to the last."""
    near = np.array([o for o in origins if abs(o[0]) < 39 and abs(o[1]) < 39])
    if len(near) <= 8:
        return near
    return near[np.round(np.linspace(0, len(near) - 1, 8)).astype(int)]


def cast(grid, free, size, origin, way):
    """The first occupied voxel (or None), and where the ray leaves it or the grid, metres."""
    u = np.asarray(origin) / size
    at = np.floor(u).astype(int)
    step = np.where(way >= 0, 1, -1)

    def leaves(i):
        return (at[i] + (step[i] > 0) - u[i]) * size[i] / way[i] if way[i] != 0 else math.inf

    while True:
        here, t = tuple(at), [leaves(i) for i in range(3)]
        axis = max(i for i in range(3) if t[i] == min(t))  # of equals, the higher axis
        at[axis] += step[axis]
        if grid[here] < free:
            return here, t[axis]
        if not 0 <= at[axis] < grid.shape[axis]:
            return None, t[axis]


def look(frame, free, size, ways):
    """Class, depth, instance and velocity of both sides, of rays that the truth stops."""
    rows = []
    for origin in frame["origins"]:
        for way in ways:
            hit, depth = cast(frame["truth"], free, size, origin, way)
            if hit is None:
                continue
            row = [frame["truth"][hit], depth, frame["truth_instances"][hit], frame["truth_flow"][hit]]
            hit, depth = cast(frame["prediction"], free, size, origin, way)
            if hit is None:
                row += [free, depth, 0, np.zeros(2)]
            else:
                row += [frame["prediction"][hit], depth]
                row += [frame["prediction_instances"][hit], frame["prediction_flow"][hit]]
            rows.append(row)
    return [np.array(column) for column in zip(*rows)]


def ray_iou(frames, free, thresholds):
    """By threshold and class, over all frames at once."""
    gt, gd, _, _, pr, pd, _, _ = [np.concatenate(c) for c in zip(*frames)]
    near = np.abs(gd - pd)
    table = np.full((len(thresholds), free), NAN)
    for j, t in enumerate(thresholds):
        for c in range(free):
            right = np.sum((gt == c) & (pr == c) & (near < t))
            either = np.sum(gt == c) + np.sum(pr == c) - right
            if either:
                table[j, c] = right / either
    return table


def ave(frames, classes):
    """Mean velocity error of rays of the right class less than 2 m apart."""
    gt, gd, _, gv, pr, pd, _, pv = [np.concatenate(c) for c in zip(*frames)]
    out = []
    for c in classes:
        right = (gt == c) & (pr == c) & (np.abs(gd - pd) < 2)
        error = np.linalg.norm(gv[right] - pv[right], axis=1)
        out.append(error.mean() if len(error) else NAN)
    return np.array(out)


def ray_pq(frames, free, things, thresholds):
    """PQ, SQ, RQ by threshold and class; segments matched frame by frame."""
    n = np.zeros((len(thresholds), free, 4))  # matched, sum of IoU, missed, invented
    for gt, gd, gi, _, pr, pd, pi, _ in frames:
        seg = np.zeros_like(gi)
        for i in set(gi.tolist()) - {0}:
            seen = set(gt[gi == i].tolist())
            if len(seen) == 1 and seen <= set(things):
                seg[gi == i] = i
        for j, t in enumerate(thresholds):
            for c in range(free):
                a = {i: (gt == c) & (seg == i) for i in set(seg[gt == c].tolist())}
                b = {i: (pr == c) & (pi == i) for i in set(pi[pr == c].tolist())}
                used = set()
                for mine in a.values():
                    best = 0
                    for k, other in b.items():
                        shared = np.sum(mine & other & (np.abs(gd - pd) < t))
                        iou = shared / (mine.sum() + other.sum() - shared)
                        if iou > 0.5:
                            best = iou
                            used.add(k)
                    n[j, c] += [best > 0, best, best == 0 and mine.sum() >= 10, 0]
                n[j, c, 3] += sum(b[k].sum() >= 10 for k in set(b) - used)
    matched, iou, missed, invented = np.moveaxis(n, -1, 0)
    some = matched + missed + invented > 0
    sq = np.where(some, iou / np.maximum(matched, 1), NAN)
    rq = np.where(some, matched / np.maximum(matched + (missed + invented) / 2, 0.5), NAN)
    return {"pq": sq * rq, "sq": sq, "rq": rq}


# --- small inputs ---------------------------------------------------------------------------------

SHAPE, SIZE, FREE = (14, 12, 6), np.array([0.5, 0.4, 0.6]), 6
THINGS, FLOW_CLASSES, THRESHOLDS = [0, 1], [0, 1, 2], [0.4, 1.0, 2.0]


def street(rng, shift, noise):
    """Ground, a wall, and boxes with instances; the prediction moves, drops and mixes some."""
    grid, ids = np.full(SHAPE, FREE), np.zeros(SHAPE, int)
    grid[:, :, 0] = 4
    grid[:, 10 + shift % 2, 1:5] = 3
    boxes = [(1, 1, 0), (9, 1, 0), (2, 7, 1), (10, 6, 1), (6, 0, 0)]
    for k, (x, y, c) in enumerate(boxes, start=1):
        if shift and k == 4:
            continue
        part = np.s_[x + shift * (k % 2): x + 3, y:y + 3, 1:3]
        grid[part], ids[part] = c, k + 10 * shift
    grid[9, 1, 1:3] = 1  # an instance of two classes
    wild = rng.random(SHAPE) < noise
    odd = 2 if shift else 3  # class 2 is predicted only, class 5 is nowhere
    grid[wild] = rng.choice([0, 1, odd, FREE, FREE, FREE, 255], wild.sum())
    return grid, ids


def make_frame(rng, number):
    truth, ti = street(rng, 0, 0.02)
    guess, pi = street(rng, 1 if number else 0, 0.04)
    flow = [rng.integers(-16, 17, SHAPE + (2,)) / 8]
    flow.append(flow[0] + rng.integers(-4, 5, SHAPE + (2,)) / 8)
    origins = [[3.1, 2.3 + 0.07 * number, 1.9], [4.6, 1.0, 2.77]]
    return {"truth": truth, "prediction": guess, "truth_instances": ti, "prediction_instances": pi,
            "truth_flow": flow[0], "prediction_flow": flow[1], "origins": origins}


def plain(value):
    """For JSON: lists, and null for NaN."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and math.isnan(value) else value


def ray_set():
    ways = directions(pitches(), np.deg2rad(np.arange(360)))
    digest = 0
    for rounded in np.round(ways.reshape(-1) * 1e6).astype(int).tolist():
        digest = (digest * 1000003 + rounded) % (2**61 - 1)
    some = [0, 45, 359, 3600, 7777, 14039]
    return {"count": len(ways), "sum": [math.fsum(ways[:, i]) for i in range(3)], "digest": digest,
            "some": [[i, *ways[i]] for i in some]}


def origins(rng):
    many = np.cumsum(rng.normal(size=(60, 3)) * [1.5, 0.3, 0.1] + [0.9, 0.1, 0], axis=0) - [20, 4, 0]
    return {"all": many, "chosen": choose(many)}


def first_hits(rng):
    grid = np.where(rng.random((7, 6, 9)) < 0.04, rng.integers(0, FREE, (7, 6, 9)), FREE)
    size, rays = np.array([0.5, 0.4, 0.25]), []
    ways = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [0.6, 0.8, 0]]
    for origin in [[1.7, 1.1, 1.3], [1.0, 0.8, 0.5], [1.5, 1.01, 1.25], [0, 0, 0]]:
        turns = rng.normal(size=(33, 3))
        for way in np.concatenate([ways, turns / np.linalg.norm(turns, axis=1, keepdims=True)]):
            hit, depth = cast(grid, FREE, size, origin, way)
            kind = FREE if hit is None else grid[hit]
            rays.append([*origin, *way, int(kind), depth])
    return {"shape": grid.shape, "size_m": size, "free": FREE, "grid": grid.reshape(-1), "rays": rays}


def scores(rng):
    frames = [make_frame(rng, number) for number in range(3)]
    pitch, azimuth = np.array([-0.75, -0.5, -0.31, -0.2, -0.1, -0.02, 0.1]), np.arange(60) * 0.105
    ways = directions(pitch, azimuth)
    seen = [look(frame, FREE, SIZE, ways) for frame in frames]
    iou, velocity = ray_iou(seen, FREE, THRESHOLDS), ave(seen, FLOW_CLASSES)
    pq = ray_pq(seen, FREE, THINGS, THRESHOLDS)
    miou, mave = np.nanmean(iou), np.nanmean(velocity)
    flat = [{k: np.asarray(v).reshape(-1) if k != "origins" else v for k, v in f.items()} for f in frames]
    for frame in flat:
        for side in ["truth_flow", "prediction_flow"]:
            frame[side] = (frame[side] * 8).astype(int)  # in eighths of 1 m/s
    return {"shape": SHAPE, "size_m": SIZE, "free": FREE, "things": THINGS, "frames": flat,
            "flow_classes": FLOW_CLASSES, "thresholds_m": THRESHOLDS, "pitches": pitch,
            "azimuths": azimuth, "rays": sum(len(s[0]) for s in seen), "ray_iou": iou,
            "mean": miou, "ave": velocity, "mave": mave,
            "score": 0.9 * miou + 0.1 * max(1 - mave, 0.0), "mean_pq": np.nanmean(pq["pq"]), **pq}


if __name__ == "__main__":
    dice = np.random.default_rng(6)
    out = {"ray_set": ray_set(), "origins": origins(dice), "first_hits": first_hits(dice),
           "scores": scores(dice)}
    print(json.dumps(plain(out), separators=(",", ":")))
