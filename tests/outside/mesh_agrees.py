"""Reads solids and points with trimesh and plyfile and compares them with the labels they were made of:
`mesh_agrees.py LABELS TOKEN GLB CUBES_PLY POINTS_PLY`. Prints what was compared."""

import json
import sys
from collections import Counter

import numpy as np
import trimesh
from plyfile import PlyData

from labels_on_disk import Labels

counted = Counter()


def close(a, b, within):
    assert np.allclose(a, b, rtol=1e-5, atol=within), f"{a} is not {b}"


def exposed(inside):
    """Unit faces of a set of voxels towards what is not in it, along each axis."""
    around = np.pad(inside, 1)
    return [int(np.count_nonzero(np.diff(around.astype(int), axis=axis))) for axis in range(3)]


def check_solid(corners, inside, labels):
    """Triangles, in the grid frame, against the voxels that they are to enclose."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normals = np.cross(b - a, c - a) / 2
    areas = np.linalg.norm(normals, axis=1)
    units = np.prod(labels.size) / labels.size
    close(np.abs(normals).sum(axis=0) / units, exposed(inside), 1e-3)
    close(np.einsum("ij,ij->i", a, normals).sum() / 3, inside.sum() * np.prod(labels.size), 1e-3)
    outward = normals / areas[:, None]
    around = np.pad(inside, 1)
    for side, expected in [(-0.25, True), (0.25, False)]:
        beside = (corners.mean(axis=1) + outward * labels.size * side - labels.lower) / labels.size
        assert (around[tuple((np.floor(beside).astype(int) + 1).T)] == expected).all()
    counted["triangles"] += len(corners)


def linear(channels):
    shares = np.array(channels) / 255
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)


def check_glb(file, labels, semantics, colors):
    scene = trimesh.load(file, process=False)
    present = [i for i, name in enumerate(labels.names) if (semantics == i).any()]
    shown = {labels.names[i].replace("_", " "): i for i in present}
    assert set(scene.graph.nodes_geometry) == set(shown)
    for name, i in shown.items():
        placed, geometry = scene.graph[name]
        mesh = scene.geometry[geometry].copy()
        mesh.apply_transform(placed)
        # x left, y up, z forward.
        check_solid(mesh.triangles[:, :, [2, 0, 1]], semantics == i, labels)
        close(mesh.visual.material.baseColorFactor[:3], linear(colors[i]) * 255, 1)
        counted["nodes"] += 1


def check_cubes(file, labels, arrays):
    ply = PlyData.read(file)
    vertices, faces = ply["vertex"].data, np.stack(ply["face"].data["vertex_indices"])
    semantics, tracks = arrays["semantics"], arrays.get("instances", np.zeros_like(arrays["semantics"]))
    assert faces.shape[1] == 4 and sorted(faces.ravel()) == list(range(len(vertices)))
    places = np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float)
    kinds = np.stack([vertices["class"], vertices["track"]], axis=1)[faces]
    assert (kinds == kinds[:, :1]).all()
    voxels = tuple(labels.occupied(semantics).T)
    known = set(zip(semantics[voxels].tolist(), tracks[voxels].tolist()))
    assert {tuple(kind) for kind in kinds[:, 0].tolist()} == known
    for label, track in known:
        own = faces[(kinds[:, 0] == (label, track)).all(axis=1)]
        triangles = np.concatenate([places[own[:, [0, 1, 2]]], places[own[:, [0, 2, 3]]]])
        check_solid(triangles, (semantics == label) & (tracks == track), labels)
    counted["quads"] += len(faces)


def check_points(file, labels, arrays):
    """Gives the colours of the classes."""
    points = PlyData.read(file)["vertex"].data
    voxels = labels.occupied(arrays["semantics"])
    at = tuple(voxels.T)
    close(np.stack([points[axis] for axis in "xyz"], axis=1), labels.centres(voxels), 1e-5)
    columns = [("class", "semantics"), ("track", "instances"), ("hits", "hits"), ("crossings", "crossings")]
    for column, array in columns:
        assert (column in points.dtype.names) == (array in arrays)
        assert array not in arrays or (points[column] == arrays[array][at]).all()
    colors = {}
    for row in points:
        color = (row["red"], row["green"], row["blue"])
        assert colors.setdefault(row["class"], color) == color
    counted["points"] += len(points)
    return colors


def main(folder, token, glb, cubes, points):
    labels = Labels(folder)
    arrays = labels.arrays(token)
    colors = check_points(points, labels, arrays)
    check_glb(glb, labels, arrays["semantics"], colors)
    check_cubes(cubes, labels, arrays)
    print(json.dumps(counted))


main(*sys.argv[1:])
