"""Reads a recording with Python's mcap and compares it, number by number, with the labels it was made of
and, if there is one, with the nuScenes log: `mcap_agrees.py FILE LABELS [TABLES]`. Prints what was compared."""

import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from labels_on_disk import Labels, matrix

KINDS = {1: "u1", 3: "<u2", 7: "<f4"}
counted = Counter()


def close(a, b, within=1e-9):
    assert np.allclose(a, b, rtol=0, atol=within), f"{a} is not {b}"


def read(file):
    """Messages by topic as (log time, message), and metadata by name."""
    topics = {}
    with open(file, "rb") as opened:
        reader = make_reader(opened, decoder_factories=[DecoderFactory()])
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        last = 0
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            assert message.log_time >= last, "messages in order of time"
            last = message.log_time
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
    return topics, metadata


def table(fields, stride, data):
    """Packed numbers as a structured array."""
    names = [field.name for field in fields]
    kinds = [KINDS[field.type] for field in fields]
    offsets = [field.offset for field in fields]
    return np.frombuffer(data, dtype={"names": names, "formats": kinds, "offsets": offsets, "itemsize": stride})


def of_message(translation, turn):
    return matrix([translation.x, translation.y, translation.z], [turn.w, turn.x, turn.y, turn.z])


def transforms(topics):
    """By parent, child and time."""
    placed = {}
    for time, message in topics.get("/tf", []):
        assert message.timestamp.ToNanoseconds() == time
        key = (message.parent_frame_id, message.child_frame_id, time)
        assert key not in placed, f"{key} twice"
        placed[key] = of_message(message.translation, message.rotation)
    return placed


def check_metadata(labels, metadata):
    classes = metadata["classes"]
    assert [classes[str(i)] for i in range(len(labels.names))] == labels.names
    assert classes[str(labels.manifest["free"])] == "free"
    counted["classes"] += len(labels.names)
    return np.array([list(bytes.fromhex(metadata["class_colors"][str(i)][1:])) for i in range(len(labels.names))])


def check_grid(labels, arrays, message, colors):
    """Every cell of a dense grid."""
    semantics = arrays["semantics"]
    nx, ny, nz = semantics.shape
    assert (message.column_count, message.row_count, len(message.data) // message.slice_stride) == (nx, ny, nz)
    assert message.row_stride == nx * message.cell_stride and message.slice_stride == ny * message.row_stride
    cells = table(message.fields, message.cell_stride, message.data).reshape(nz, ny, nx).transpose(2, 1, 0)
    assert (cells["label"] == semantics).all()
    stands = (semantics != labels.manifest["free"]) & (semantics != 255)
    assert (cells["alpha"] == np.where(stands, 255, 0)).all()
    for channel, name in enumerate(["red", "green", "blue"]):
        assert (cells[name][stands] == colors[semantics[stands], channel]).all()
    close(of_message(message.pose.position, message.pose.orientation), matrix(labels.lower, [1, 0, 0, 0]))
    close([message.cell_size.x, message.cell_size.y, message.cell_size.z], labels.size)
    counted["cells"] += semantics.size


def check_voxels(labels, arrays, message, colors):
    """Every occupied centre."""
    rows = table(message.fields, message.point_stride, message.data)
    voxels = labels.occupied(arrays["semantics"])
    at = tuple(voxels.T)
    assert len(rows) == len(voxels)
    close(np.stack([rows["x"], rows["y"], rows["z"]], axis=1), labels.centres(voxels), 1e-5)
    assert (rows["class"] == arrays["semantics"][at]).all()
    assert (np.stack([rows["red"], rows["green"], rows["blue"]], axis=1) == colors[rows["class"]]).all()
    for column, array in [("track", "instances"), ("hits", "hits"), ("crossings", "crossings")]:
        assert (column in rows.dtype.names) == (array in arrays), column
        if array in arrays:
            assert (rows[column] == arrays[array][at]).all()
            counted[column] += int((rows[column] > 0).sum())
    counted["centres"] += len(rows)


def check_labels(labels, topics, colors):
    """Grids and centres of all keyframes, and where their grids stand."""
    grids, voxels, placed = topics["/occupancy/grid"], topics["/occupancy/voxels"], transforms(topics)
    assert len(grids) == len(voxels) == len(labels.poses)
    in_order = sorted(labels.poses, key=lambda pose: pose["time_ns"])
    for pose, (time, grid), (_, points) in zip(in_order, grids, voxels):
        assert time == pose["time_ns"] == grid.timestamp.ToNanoseconds() == points.timestamp.ToNanoseconds()
        assert grid.frame_id == points.frame_id == "grid"
        arrays = labels.arrays(pose["token"])
        check_grid(labels, arrays, grid, colors)
        check_voxels(labels, arrays, points, colors)
        close(placed["map", "grid", time], labels.world_from_grid(pose))
        if labels.manifest["grid"]["frame"] == "ego":
            close(placed["map", "base_link", time], placed["map", "grid", time])
        counted["keyframes"] += 1


class Log:
    """A log's tables."""

    def __init__(self, tables):
        self.tables, self.root = Path(tables), Path(tables).parent
        self.sensors = {one["token"]: one for one in self.rows("sensor")}
        self.mounted = {one["token"]: one for one in self.rows("calibrated_sensor")}
        self.egos = {one["token"]: one for one in self.rows("ego_pose")}
        self.captures = {}
        for capture in self.rows("sample_data"):
            channel = self.sensors[self.mounted[capture["calibrated_sensor_token"]]["sensor_token"]]["channel"]
            self.captures[channel, capture["timestamp"] * 1000] = capture

    def rows(self, name):
        """A table; logs without point labels do not have all."""
        file = self.tables / f"{name}.json"
        return json.loads(file.read_text()) if file.exists() else []

    def poses(self, capture):
        """world from ego, ego from sensor."""
        ego, mounted = self.egos[capture["ego_pose_token"]], self.mounted[capture["calibrated_sensor_token"]]
        return [matrix(row["translation"], row["rotation"]) for row in (ego, mounted)]


def check_sweeps(log, topics):
    placed, meanings = transforms(topics), {}
    files = {row["sample_data_token"]: log.root / row["filename"] for row in log.rows("lidarseg")}
    for topic in [topic for topic in topics if topic.endswith("/points")]:
        lidar = topic.split("/")[1]
        for time, message in topics[topic]:
            capture = log.captures[lidar, time]
            world_from_ego, ego_from_lidar = log.poses(capture)
            close(placed["map", "base_link", time], world_from_ego)
            close(placed["base_link", lidar, time], ego_from_lidar)
            logged = np.fromfile(log.root / capture["filename"], dtype="<f4").reshape(-1, 5)
            rows = table(message.fields, message.point_stride, message.data)
            assert message.frame_id == lidar
            assert (np.stack([rows["x"], rows["y"], rows["z"]], axis=1) == logged[:, :3]).all()
            counted["sweeps"] += 1
            counted["points"] += len(rows)
            if "label" in rows.dtype.names:
                raw = np.fromfile(files[capture["token"]], dtype="u1")
                for before, after in set(zip(raw.tolist(), rows["label"].tolist())):
                    assert meanings.setdefault(before, after) == after, "a raw label means one class"
                counted["labelled"] += len(rows)


def check_cameras(log, topics):
    placed = transforms(topics)
    for topic in [topic for topic in topics if topic.endswith("/calibration")]:
        camera = topic.split("/")[1]
        for time, message in topics[topic]:
            capture = log.captures[camera, time]
            world_from_ego, ego_from_camera = log.poses(capture)
            close(placed["map", camera, time], world_from_ego @ ego_from_camera)
            known = log.mounted[capture["calibrated_sensor_token"]]["camera_intrinsic"]
            close(np.reshape(message.K, (3, 3)), known)
            assert (message.width, message.height) == (capture["width"], capture["height"])
            counted["calibrations"] += 1
        for time, message in topics.get(f"/{camera}/image", []):
            file = log.root / log.captures[camera, time]["filename"]
            assert message.data == file.read_bytes() and message.format in ("png", "jpeg")
            counted["images"] += 1


def check_boxes(log, labels, topics):
    """Every box that is annotated at a keyframe, and no other."""
    known = {}
    times = {row["token"]: row["timestamp"] * 1000 for row in log.rows("sample")}
    categories = {row["token"]: row["name"] for row in log.rows("category")}
    instances = {row["token"]: categories[row["category_token"]] for row in log.rows("instance")}
    for row in log.rows("sample_annotation"):
        known.setdefault(times[row["sample_token"]], {})[row["instance_token"]] = row
    tracks = {track["id"]: track for track in labels.manifest["scenes"][labels.scene]["tracks"]}
    for time, message in topics["/annotations"]:
        assert [deletion.type for deletion in message.deletions] == [1], "all that stood before goes"
        assert len({entity.id for entity in message.entities}) == len(message.entities) == len(known[time])
        for entity in message.entities:
            row, (cube,) = known[time][entity.id], entity.cubes
            said = {pair.key: pair.value for pair in entity.metadata}
            assert said["category"] == instances[entity.id] and entity.frame_id == "map"
            assert said["track"] == str(tracks[entity.id]["index"]) and said["class"] == tracks[entity.id]["class"]
            close(of_message(cube.pose.position, cube.pose.orientation), matrix(row["translation"], row["rotation"]))
            width, length, height = row["size"]
            close([cube.size.x, cube.size.y, cube.size.z], [length, width, height])
            counted["boxes"] += 1


def main(file, folder, tables=None):
    labels = Labels(folder)
    topics, metadata = read(file)
    check_labels(labels, topics, check_metadata(labels, metadata))
    if tables:
        log = Log(tables)
        check_sweeps(log, topics)
        check_cameras(log, topics)
        check_boxes(log, labels, topics)
    print(json.dumps(counted))


main(*sys.argv[1:])
