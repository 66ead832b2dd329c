"""numba's walk on the exported rays."""

import numpy as np

from common import array, keyframe, measure, tell
from walk import count_rays


def main():
    grid = keyframe()
    rays = array("rays.f64", "f8", -1, 2, 3)
    starts = array("ray_starts.u64", "u8")
    rays = (rays - grid["min_m"]) / grid["voxel_size_m"]
    origins = rays[np.minimum(starts[:-1], len(rays) - 1).astype(np.int64), 0].copy()
    origin_of = np.repeat(np.arange(len(origins)), np.diff(starts.astype(np.int64)))
    ends = rays[:, 1].copy()
    count_rays(origins, origin_of[:1], ends[:1], *grids(grid))

    hits, crossings = grids(grid)
    measure("rays, numba", "ray", len(ends), lambda: count_rays(origins, origin_of, ends, hits, crossings))
    tell("rays, numba: free", "voxels", ((hits == 0) & (crossings > 0)).sum())
    tell("rays, numba: hit", "voxels", (hits > 0).sum())


def grids(grid):
    return np.zeros(grid["shape"], np.uint32), np.zeros(grid["shape"], np.uint32)


main()
