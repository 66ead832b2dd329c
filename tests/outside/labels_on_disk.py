"""Labels as the program leaves them, read with numpy alone."""

import json
from pathlib import Path

import numpy as np


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

    def arrays(self, token):
        """The keyframe's arrays by name."""
        files = sorted((self.folder / "gts" / self.scene / token).glob("*.npz"))
        return {name: array for file in files for name, array in np.load(file).items()}

    def occupied(self, semantics):
        """Indices of the voxels where something stands, in flat order."""
        return np.argwhere((semantics != self.manifest["free"]) & (semantics != 255))

    def centres(self, voxels):
        return self.lower + (voxels + 0.5) * self.size
