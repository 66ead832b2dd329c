"""Labels as the program leaves them, read with numpy alone."""

import json
from pathlib import Path

import numpy as np


def matrix(translation, wxyz):
    """A pose as a matrix of 4 x 4."""
    w, x, y, z = wxyz
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = turn, translation
    return placed


class Labels:
    """The first scene of a label tree."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.manifest = json.loads((self.folder / "manifest.json").read_text())
        self.scene = next(iter(self.manifest["scenes"]))
        self.poses = self.manifest["scenes"][self.scene]["poses"]
        self.names = [one["name"] for one in self.manifest["classes"] if one["id"] != self.manifest["free"]]
        grid = self.manifest["grid"]
        self.lower, self.size = np.array(grid["min_m"]), np.array(grid["voxel_size_m"])

    def world_from_grid(self, pose):
        known = [matrix(pose[name]["translation"], pose[name]["rotation"]) for name in ("world_from_ego", "ego_from_lidar")]
        return known[0] @ known[1] if self.manifest["grid"]["frame"] == "lidar" else known[0]

    def arrays(self, token):
        """The keyframe's arrays by name."""
        files = sorted((self.folder / "gts" / self.scene / token).glob("*.npz"))
        return {name: array for file in files for name, array in np.load(file).items()}

    def occupied(self, semantics):
        """Indices of the voxels where something stands, in flat order."""
        return np.argwhere((semantics != self.manifest["free"]) & (semantics != 255))

    def centres(self, voxels):
        return self.lower + (voxels + 0.5) * self.size
