"""The scenes that the cost model is fitted on, those it is checked on, and how each is labelled.

A scene is a world and the keys that are set in it; no world of the check is one of the fit. Of `walk` it is known
that the model expects too much: rays among people are shorter than any table tells.
"""

TOP = "lidar.LIDAR_TOP."


def lidar(beams, azimuths, rate_hz):
    pattern = TOP + "pattern.spinning."
    return [
        f"{pattern}beams.even.count={beams}",
        f"{pattern}azimuths={azimuths}",
        f"{TOP}rate_hz={rate_hz}",
    ]


def drive(duration_s, keyframe_hz):
    return [f"duration_s={duration_s}", f"keyframe_hz={keyframe_hz}"]


STREET = "configs/worlds/street.toml"
HIGHWAY = "configs/worlds/highway.toml"
CROSSING = "configs/worlds/crossing.toml"
SCALE = "configs/worlds/scale.toml"
NUSCENES = "benches/worlds/nuscenes_like.toml"
CAMPUS = "configs/worlds/campus.toml"
CROWD = "configs/worlds/crowd.toml"
HILL = "configs/worlds/hill.toml"
WAYMO = "benches/worlds/waymo_like.toml"

PRECISE = ["--preset", "precise"]
OCC3D = ["--preset", "occ3d-nuscenes"]
PAPER = ["--preset", "paper"]
EVIDENCE = ["--evidence"]


def grid(size_m):
    return ["--set", f"grid.voxel_size_m={size_m}"]


def extent(half_m, low_m, high_m):
    low, high = [-half_m, -half_m, low_m], [half_m, half_m, high_m]
    return ["--set", f"grid.min_m={low}", "--set", f"grid.max_m={high}"]


# How a scene is labelled: a name, flags, threads.
RUNS = {
    "precise": (PRECISE, 1),
    "precise-0.2": (PRECISE + grid(0.2), 1),
    "precise-0.8": (PRECISE + grid(0.8), 1),
    "precise-evidence": (PRECISE + EVIDENCE, 1),
    "precise-2": (PRECISE, 2),
    "occ3d": (OCC3D, 1),
    "occ3d-0.2": (OCC3D + grid(0.2), 1),
    "occ3d-0.8": (OCC3D + grid(0.8), 1),
    "occ3d-evidence": (OCC3D + EVIDENCE, 1),
    "occ3d-evidence-2": (OCC3D + EVIDENCE, 2),
    "paper": (PAPER, 1),
    "precise-0.2-evidence": (PRECISE + grid(0.2) + EVIDENCE, 2),
    "precise-wide": (PRECISE + extent(51.2, -5, 3), 1),
    "precise-narrow": (PRECISE + extent(20, -1, 5.4) + grid(0.2), 1),
    "occ3d-wide": (OCC3D + extent(51.2, -5, 3), 1),
}

# A scene whose point labels are of another taxonomy than the presets'.
TAXONOMIES = {"campus": "panommocc", "campus-dense": "panommocc", "crowd": "mobileocc", "crowd-48": "mobileocc"}

A = ["precise", "occ3d", "precise-0.2", "occ3d-evidence"]
B = ["precise", "occ3d", "precise-0.8", "precise-evidence", "occ3d-0.2"]
C = ["precise", "occ3d", "precise-2", "occ3d-0.8", "paper"]
D = ["precise", "occ3d", "precise-0.2-evidence", "occ3d-evidence-2"]
E = ["precise-wide", "precise-narrow", "occ3d-wide"]

# Set, name, world, keys, runs.
SCENES = [
    ("fit", "street-sparse", STREET, lidar(32, 1600, 10) + drive(2.1, 2), A),
    ("fit", "street-dense", STREET, lidar(64, 1800, 20) + drive(2.1, 10), B),
    ("fit", "highway", HIGHWAY, lidar(32, 1084, 20) + drive(16, 2), C),
    ("fit", "highway-short", HIGHWAY, lidar(32, 1084, 10) + drive(6, 2), D),
    ("fit", "crossing-slow", CROSSING, lidar(32, 1084, 4) + drive(20, 2), B + E),
    ("fit", "crossing-64", CROSSING, lidar(64, 1084, 10) + drive(10, 2), C),
    ("fit", "crossing-48", CROSSING, lidar(48, 1084, 20) + drive(5, 1), D),
    ("fit", "road-20", NUSCENES, lidar(32, 1084, 20) + drive(10, 2), A),
    ("fit", "scale", SCALE, lidar(32, 1024, 10) + drive(20, 2), D + E),
    ("fit", "scale-fast", SCALE, lidar(40, 1024, 5) + drive(10, 1) + ["ego.trajectory.straight.speed_mps=20.0"], A),
    ("fit", "campus", CAMPUS, ["lidar.MID360.pattern.rosette.shots=20000"], A),
    ("fit", "campus-dense", CAMPUS, ["lidar.MID360.pattern.rosette.shots=80000", "duration_s=6"], C),
    ("check", "hill", HILL, lidar(32, 1084, 10) + drive(18, 2), D),
    ("check", "hill-64", HILL, lidar(64, 1084, 10) + drive(6, 2), B + E),
    ("walk", "crowd", CROWD, lidar(32, 900, 10) + drive(10, 2), C),
    ("walk", "crowd-48", CROWD, lidar(48, 900, 20) + drive(9, 1), A),
    ("check", "five-lidars", WAYMO, drive(5, 5), B),
    ("check", "five-lidars-2", WAYMO, drive(3, 2), D),
]
