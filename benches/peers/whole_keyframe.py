"""A whole keyframe with NumPy and numba: points moved into the grid, classes counted, rays cast,
states decided, and what six cameras see marked by rays to the centres of all voxels.

The preset `precise` without boxes, as one would write it on an afternoon.
"""

import numpy as np
from numba import njit

from common import array, keyframe, measure, tell
from walk import begin, count_rays, is_inside, next_axis

UNOBSERVED, FREE, OCCUPIED = 0, 1, 2


@njit(cache=True)
def look(start, targets, occupied, seen):
    """Marks all that rays to the targets see, up to the first occupied voxel."""
    voxel, step = np.empty(3, np.int64), np.empty(3, np.int64)
    reach, stride = np.empty(3), np.empty(3)
    for target in range(len(targets)):
        begin(start, targets[target], voxel, step, reach, stride)
        while True:
            if is_inside(voxel, seen.shape):
                seen[voxel[0], voxel[1], voxel[2]] = True
                if occupied[voxel[0], voxel[1], voxel[2]]:
                    break
            axis = next_axis(reach)
            if reach[axis] > 1.0:
                break
            voxel[axis] += step[axis]
            reach[axis] += stride[axis]


def to_voxels(points, grid):
    pose = np.array(grid["grid_from_world"])
    return (points @ pose[:3, :3].T + pose[:3, 3] - grid["min_m"]) / grid["voxel_size_m"]


def histogram(ends, classes, grid):
    shape, count = np.array(grid["shape"]), grid["classes"]
    voxels = np.floor(ends).astype(np.int64)
    inside = ((voxels >= 0) & (voxels < shape)).all(axis=1)
    flat = np.ravel_multi_index(voxels[inside].T, shape)
    votes = np.bincount(flat * count + classes[inside], minlength=shape.prod() * count)
    return votes.reshape(*shape, count)


def centres_in_view(camera, grid):
    """The centres of voxels that a camera has in view, in voxels."""
    shape = grid["shape"]
    centres = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij"), -1).reshape(-1, 3)
    camera_from_grid = np.linalg.inv(np.array(camera["grid_from_camera"]))
    places = centres * grid["voxel_size_m"] + grid["min_m"]
    way = places @ camera_from_grid[:3, :3].T + camera_from_grid[:3, 3]
    ahead = (way[:, 2] > 0.0) & (np.linalg.norm(way, axis=1) <= grid["depth_max_m"])
    with np.errstate(all="ignore"):
        pixels = way @ np.array(camera["matrix"]).T
        pixels = pixels[:, :2] / pixels[:, 2:]
    inside = ((pixels >= 0.0) & (pixels < [camera["width"], camera["height"]])).all(axis=1)
    return centres[ahead & inside]


def cameras(occupied, grid):
    seen = np.zeros(grid["shape"], np.bool_)
    for camera in grid["cameras"]:
        place = np.array(camera["grid_from_camera"])[:3, 3]
        start = (place - grid["min_m"]) / grid["voxel_size_m"]
        look(start, centres_in_view(camera, grid), occupied, seen)
    return seen


def label(points, classes, origins, origin_of, grid):
    ends, origins = to_voxels(points, grid), to_voxels(origins, grid)
    votes = histogram(ends, classes, grid)
    semantics = votes.argmax(-1)
    hits, crossings = np.zeros(grid["shape"], np.uint32), np.zeros(grid["shape"], np.uint32)
    count_rays(origins, origin_of, ends, hits, crossings)
    states = np.where(hits > 0, OCCUPIED, np.where(crossings > 0, FREE, UNOBSERVED))
    semantics[states != OCCUPIED] = grid["classes"]
    return semantics, states, cameras(states == OCCUPIED, grid) & (states != UNOBSERVED)


def main():
    grid = keyframe()
    grid["min_m"] = np.array(grid["min_m"])
    points, classes = array("points.f64", "f8", -1, 3), array("classes.u8", "u1")
    origins, starts = array("origins.f64", "f8", -1, 3), array("starts.u64", "u8").astype(np.int64)
    origin_of = np.repeat(np.arange(len(origins)), np.diff(starts))
    label(points[:1], classes[:1], origins, origin_of[:1], grid)

    _, states, seen = measure(
        "keyframe, numba + NumPy", "ray", len(points), lambda: label(points, classes, origins, origin_of, grid)
    )
    tell("keyframe, numba + NumPy: free", "voxels", (states == FREE).sum())
    tell("keyframe, numba + NumPy: occupied", "voxels", (states == OCCUPIED).sum())
    tell("keyframe, numba + NumPy: seen", "voxels", seen.sum())


main()
