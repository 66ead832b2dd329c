"""The walk of Amanatides and Woo (1987) as one writes it with numba."""

import numpy as np
from numba import njit


@njit(cache=True)
def begin(start, end, voxel, step, reach, stride):
    """Where the walk begins, which way it steps, and at which share of the way it crosses faces."""
    for axis in range(3):
        way = end[axis] - start[axis]
        voxel[axis] = int(np.floor(start[axis]))
        step[axis] = 1 if way > 0.0 else -1
        if way == 0.0:
            reach[axis] = stride[axis] = np.inf
            continue
        face = voxel[axis] + 1 if way > 0.0 else voxel[axis]
        reach[axis] = (face - start[axis]) / way
        stride[axis] = abs(1.0 / way)


@njit(cache=True)
def next_axis(reach):
    if reach[0] < reach[1]:
        return 0 if reach[0] < reach[2] else 2
    return 1 if reach[1] < reach[2] else 2


@njit(cache=True)
def is_inside(voxel, shape):
    return (0 <= voxel[0] < shape[0]) and (0 <= voxel[1] < shape[1]) and (0 <= voxel[2] < shape[2])


@njit(cache=True)
def count_rays(origins, origin_of, ends, hits, crossings):
    """Walks from each end that is in the grid towards its origin, as far as the grid goes."""
    shape = hits.shape
    voxel, step = np.empty(3, np.int64), np.empty(3, np.int64)
    reach, stride = np.empty(3), np.empty(3)
    for ray in range(len(ends)):
        begin(ends[ray], origins[origin_of[ray]], voxel, step, reach, stride)
        if not is_inside(voxel, shape):
            continue
        hits[voxel[0], voxel[1], voxel[2]] += 1
        while True:
            axis = next_axis(reach)
            if reach[axis] > 1.0:
                break
            voxel[axis] += step[axis]
            if voxel[axis] < 0 or voxel[axis] >= shape[axis]:
                break
            reach[axis] += stride[axis]
            crossings[voxel[0], voxel[1], voxel[2]] += 1
