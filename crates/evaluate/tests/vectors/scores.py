"""The scores of docs/scores.md as small statements, and the numbers that they give.

`python scores.py > scores.json` draws the inputs (seeded) and writes them with what is expected of
them; the test `scores` asks the same of the library. Needs numpy and scipy.
"""

import itertools
import json

import numpy as np
from scipy.spatial.distance import cdist

UNLABELLED = 255


def none_if_nan(x):
    return None if np.isnan(x) else float(x)


def mean(xs):
    xs = [x for x in xs if x is not None and not np.isnan(x)]
    return float(np.mean(xs)) if xs else None


def share(part, whole):
    return part / whole if whole else np.nan


def confusion(frames, rules):
    """Rows truth, columns prediction; the last column: the prediction says nothing."""
    n = len(rules["classes"])
    matrix = np.zeros((n + 1, n + 2), int)
    for f in frames:
        asked = f["mask"] & (f["truth"] != UNLABELLED) & ~np.isin(f["truth"], rules["ignored"])
        predicted = np.where(f["prediction"] == UNLABELLED, n + 1, f["prediction"])
        np.add.at(matrix, (f["truth"][asked], predicted[asked]), 1)
    return matrix


def semantic(matrix, rules):
    n = len(rules["classes"])
    right, truth = np.diag(matrix), matrix.sum(1)
    predicted = matrix.sum(0)[: n + 1]
    iou = [share(right[c], truth[c] + predicted[c] - right[c]) for c in range(n + 1)]
    there = [iou[c] if truth[c] else np.nan for c in range(n + 1)]
    f1 = [share(2 * right[c], truth[c] + predicted[c]) if truth[c] else np.nan for c in range(n + 1)]
    both, t, p = matrix[:n, :n].sum(), truth[:n].sum(), predicted[:n].sum()
    occupied = {"iou": share(both, t + p - both), "precision": share(both, p), "recall": share(both, t)}
    completed = [0 if np.isnan(iou[c]) else iou[c] for c in range(n) if c not in rules["ignored"]]
    return {
        "voxels": int(matrix.sum()),
        "miou": mean(there[:n]),
        "accuracy": none_if_nan(share(right.sum(), matrix.sum())),
        "f1": mean(f1[:n]),
        "occupied": {k: none_if_nan(v) for k, v in occupied.items()},
        "completion": {k: float(np.nan_to_num(v)) for k, v in occupied.items()}
        | {"miou": float(np.mean(completed))},
        "classes": [
            {"iou": none_if_nan(there[c]), "precision": none_if_nan(share(right[c], predicted[c])),
             "recall": none_if_nan(share(right[c], truth[c])), "f1": none_if_nan(f1[c])}
            for c in range(n + 1)
        ],
        "confusion": matrix.tolist(),
    }


def centres(rules):
    axes = [lo + (np.arange(n) + 0.5) * s
            for lo, n, s in zip(rules["min_m"], rules["shape"], rules["size_m"])]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)


def rings(frames, rules):
    distance = np.hypot(*centres(rules)[:, :2].T)
    edges = [0, *rules["ring_m"], np.inf]
    for low, high in zip(edges, edges[1:]):
        within = (distance >= low) & (distance < high)
        yield [f | {"mask": f["mask"] & within} for f in frames]


def f_score(frames, rules):
    n, each, chamfer = len(rules["classes"]), [], []
    for f in frames:
        points = []
        for side in ("truth", "prediction"):
            void = np.isin(f[side], [n, UNLABELLED, *rules["ignored"]])
            points.append(centres(rules)[f["mask"] & ~void])
        if not len(points[0]) or not len(points[1]):
            each.append((0, 0, 0))
            continue
        between = cdist(*points)
        to_prediction, to_truth = between.min(1), between.min(0)
        limit = rules["f_threshold_m"]
        complete, accurate = (to_prediction < limit).mean(), (to_truth < limit).mean()
        each.append((2 / (1 / (accurate + 1e-8) + 1 / (complete + 1e-8)), complete, accurate))
        chamfer.append(to_prediction.mean() + to_truth.mean())
    f, complete, accurate = np.mean(each, 0)
    return {"f_score": f, "completeness": complete, "accuracy": accurate, "chamfer_m": mean(chamfer)}


def segments(classes, instances, rules):
    """The segment of each voxel, as (class, instance); stuff and what has no instance: 0."""
    return [(int(c), int(i) if c in rules["things"] else 0) for c, i in zip(classes, instances)]


def panoptic(frames, rules, matrix):
    n = len(rules["classes"])
    overlap, missed, spurious = [[] for _ in range(n)], [0] * n, [0] * n
    for f in frames:
        m = f["mask"]
        void = np.isin(f["truth"][m], [UNLABELLED, *rules["ignored"]])
        truth = segments(f["truth"][m], f["truth_instances"][m], rules)
        predicted = segments(f["prediction"][m], f["prediction_instances"][m], rules)
        truths = sorted({t for t, v in zip(truth, void) if not v and t[0] < n})
        predictions = sorted({p for p in predicted if p[0] < n and p[0] not in rules["ignored"]})
        at = lambda all, one: np.array([x == one for x in all], bool)
        matched = set()
        for t, p in itertools.product(truths, predictions):
            inside = at(predicted, p) & ~void
            both, union = (at(truth, t) & inside).sum(), (at(truth, t) | inside).sum()
            if t[0] == p[0] and both / union > 0.5:
                overlap[t[0]].append(both / union)
                matched |= {("t", t), ("p", p)}
        for t in truths:
            large = at(truth, t).sum() >= rules["min_segment_voxels"]
            missed[t[0]] += ("t", t) not in matched and large
        for p in predictions:
            voxels, in_void = at(predicted, p).sum(), (at(predicted, p) & void).sum()
            judged = voxels >= rules["min_segment_voxels"] and in_void / voxels <= 0.5
            spurious[p[0]] += ("p", p) not in matched and judged
    classes, dagger = [], []
    for c in range(n):
        tp, halves = len(overlap[c]), len(overlap[c]) + (missed[c] + spurious[c]) / 2
        sq, rq = (np.mean(overlap[c]) if tp else 0), share(tp, halves)
        pq = sq * rq if halves else np.nan
        iou = share(matrix[c, c], matrix[c].sum() + matrix[:, c].sum() - matrix[c, c])
        dagger.append(pq if c in rules["things"] or not halves else iou)
        classes.append({"pq": none_if_nan(pq), "sq": none_if_nan(sq if halves else np.nan),
                        "rq": none_if_nan(rq), "matched": tp, "missed": int(missed[c]),
                        "spurious": int(spurious[c])})
    over = lambda which: {k: mean([classes[c][k] for c in which]) for k in ("pq", "sq", "rq")}
    stuff = [c for c in range(n) if c not in rules["things"]]
    return {"all": over(range(n)), "things": over(rules["things"]), "stuff": over(stuff),
            "pq_dagger": mean(dagger), "classes": classes}


def objects(f, side, c, rules):
    """Centre and velocity of each instance of a class, in order of its number."""
    found = []
    of_class = f["mask"] & (f[side] == c) & (f[side + "_instances"] > 0)
    for i in np.unique(f[side + "_instances"][of_class]):
        at = of_class & (f[side + "_instances"] == i)
        flow = f[side + "_flow"][at][:, :2]
        known = np.isfinite(flow).all(1)
        if known.any():
            found.append((centres(rules)[at][:, :2].mean(0), flow[known].mean(0)))
    return found


def velocity(frames, rules):
    classes = []
    for c in rules["flow_classes"]:
        all_voxels, right, detected = [], [], []
        for f in frames:
            known = np.isfinite(f["truth_flow"][:, :2]).all(1)
            at = f["mask"] & (f["truth"] == c) & known
            predicted = f["prediction_flow"][:, :2]
            predicted = np.where(np.isfinite(predicted).all(1)[:, None], predicted, 0)
            error = np.linalg.norm(f["truth_flow"][:, :2] - predicted, axis=1)
            all_voxels += error[at].tolist()
            right += error[at & (f["prediction"] == c)].tolist()
            truth, found = objects(f, "truth", c, rules), objects(f, "prediction", c, rules)
            pairs = sorted((np.linalg.norm(a[0] - b[0]), t, p)
                           for (t, a), (p, b) in itertools.product(enumerate(truth), enumerate(found)))
            used = set()
            for distance, t, p in pairs:
                if distance <= rules["detection_m"] and not {("t", t), ("p", p)} & used:
                    used |= {("t", t), ("p", p)}
                    detected.append(np.linalg.norm(truth[t][1] - found[p][1]))
        classes.append({"ave_t_mps": mean(all_voxels), "ave_o_mps": mean(right),
                        "ave_d_mps": mean(detected), "voxels": len(all_voxels),
                        "right": len(right), "detections": len(detected)})
    return {k: mean([c[k] for c in classes]) for k in ("ave_t_mps", "ave_o_mps", "ave_d_mps")} | {
        "classes": classes}


def expected(frames, rules):
    matrix = confusion(frames, rules)
    by_ring = rings(frames, rules) if rules["ring_m"] else []
    return {
        "semantic": semantic(matrix, rules),
        "by_ring": [{"semantic": semantic(confusion(ring, rules), rules)} for ring in by_ring],
        "f_score": f_score(frames, rules),
        "panoptic": panoptic(frames, rules, matrix),
        "velocity": velocity(frames, rules),
    }


def draw(rng, rules, noise):
    """Blobs of classes with instances, and a prediction that differs from them here and there."""
    n, shape = len(rules["classes"]), rules["shape"]
    voxels = int(np.prod(shape))
    blocks = rng.choice([*range(n), n, n, UNLABELLED], size=[-(-s // 2) for s in shape])
    truth = np.kron(blocks, np.ones((2, 2, 2), int))[: shape[0], : shape[1], : shape[2]].ravel()
    numbers = np.kron(rng.integers(0, 4, blocks.shape), np.ones((2, 2, 2), int))
    instances = numbers[: shape[0], : shape[1], : shape[2]].ravel()
    changed = rng.random(voxels) < noise
    other = rng.choice([*range(n + 1), UNLABELLED], voxels, p=[*[0.9 / (n + 1)] * (n + 1), 0.1])
    flow = np.round(rng.normal(0, 2, (2, voxels, 3)), 2)
    flow[0] = np.round(instances[:, None] + flow[0] / 10, 2)
    flow[1] = np.round(flow[0] + flow[1] / 4, 2)
    flow[:, rng.random(voxels) < 0.05] = np.nan
    flow[1, rng.random(voxels) < 0.05] = np.nan
    return {
        "truth": truth, "prediction": np.where(changed, other, truth),
        "mask": rng.random(voxels) < 0.85, "truth_instances": instances,
        "prediction_instances": np.where(rng.random(voxels) < noise / 2, 3, (instances + 1) % 5),
        "truth_flow": flow[0].astype(np.float32).astype(float),
        "prediction_flow": flow[1].astype(np.float32).astype(float),
    }


def written(f):
    """As JSON has it: what is no number is null, and numbers are short."""
    short = lambda rows: [[None if np.isnan(x) else round(float(x), 2) for x in row] for row in rows]
    return {k: short(v) if k.endswith("flow") else v.astype(int).tolist() for k, v in f.items()}


def main():
    rng = np.random.default_rng(6)
    base = {"classes": ["car", "walker", "road", "wall"], "ignored": [], "things": [0, 1],
            "flow_classes": [0, 1], "min_m": [-1.2, -0.8, -0.4], "shape": [6, 5, 4],
            "size_m": [0.4, 0.4, 0.4], "ring_m": [], "f_threshold_m": 0.6, "detection_m": 2.0,
            "min_segment_voxels": 0}
    changes = [
        ({}, 0.1), ({}, 0.5),
        ({"ring_m": [0.5, 1.1], "min_segment_voxels": 4}, 0.3),
        ({"ignored": [3], "detection_m": 0.5}, 0.3),
        ({"size_m": [0.1, 0.1, 0.2], "f_threshold_m": 0.15}, 0.4),
        ({"classes": ["car", "walker", "road", "wall", "unseen"], "f_threshold_m": 0.3}, 0.05),
    ]
    cases = []
    for change, noise in changes:
        rules = base | change
        drawn = rules | {"classes": rules["classes"][:4]}
        frames = [draw(rng, drawn, noise) for _ in range(2)]
        if drawn != rules:  # One more class, that no voxel has: free moves up.
            for f in frames:
                for side in ("truth", "prediction"):
                    f[side] = np.where(f[side] == 4, 5, f[side])
        if change.get("min_segment_voxels"):  # And a keyframe with nothing on one side.
            frames.append(frames[0] | {"prediction": np.full_like(frames[0]["prediction"], 4)})
        cases.append({"rules": rules, "frames": [written(f) for f in frames],
                      "expected": expected(frames, rules)})
    print(json.dumps(cases, separators=(",", ":"), allow_nan=False))


if __name__ == "__main__":
    main()
