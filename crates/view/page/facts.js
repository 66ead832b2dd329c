// What is known of a voxel, as names and values.

import { NO_LABEL } from "./keyframes.js";
import { centreOf, voxelAt } from "./voxels.js";

/** The facts of a voxel of a keyframe with its counts. */
export function factsOf(scene, keyframe, flat, colors) {
    const id = keyframe.semantics[flat];
    const state = stateOf(keyframe, flat);
    const rows = [
        ["state", state],
        ...place(keyframe, flat),
        ...evidence(scene, keyframe, flat),
        ...track(scene, keyframe, flat),
        ...flow(keyframe, flat),
        ["scene", scene.name],
        ["keyframe", keyframe.token],
        ...(keyframe.time_ns === null ? [] : [["time", `${keyframe.time_ns} ns`]]),
        ...scene.about.filter(([name]) => PROVENANCE.includes(name)),
    ];
    const isOccupied = keyframe.isOccupied(flat);
    const name = isOccupied ? (scene.classes[id] ?? `class ${id}`) : state;
    return { flat, class: name, color: isOccupied ? (colors[id] ?? GREY) : GREY, rows };
}

const PROVENANCE = ["program", "preset", "dialect", "configuration"];
const GREY = [120, 128, 140];

function stateOf(keyframe, flat) {
    if (keyframe.semantics[flat] === NO_LABEL) return "no label";
    if (keyframe.isOccupied(flat)) return keyframe.isObserved(flat) ? "occupied" : "occupied, not observed";
    return keyframe.isObserved(flat) ? keyframe.emptyName() : "unobserved";
}

function place(keyframe, flat) {
    const voxel = voxelAt(keyframe.shape, flat);
    const centre = centreOf(keyframe, voxel).map((metres) => metres.toFixed(2));
    return [["voxel", voxel.join(", ")], ["centre", `${centre.join(", ")} m`]];
}

function evidence(scene, keyframe, flat) {
    const counts = ["hits", "crossings"].filter((name) => keyframe[name]);
    const rows = counts.map((name) => [name, countText(keyframe[name][flat])]);
    if (keyframe.camera_bits) {
        const seen = scene.cameras.filter((_, bit) => (keyframe.camera_bits[flat] >> bit) & 1);
        rows.push(["seen by", seen.join(", ") || "no camera"]);
    } else if (keyframe.hasCameras()) {
        rows.push(["seen by", keyframe.isHidden(flat) ? "no camera" : "some camera"]);
    }
    return rows;
}

/** Counts of files saturate. */
function countText(count) {
    return count === 65535 ? "65535 or more" : String(count);
}

function track(scene, keyframe, flat) {
    const index = keyframe.instances?.[flat];
    if (!index) return [];
    const known = scene.tracks.find(([other]) => other === index);
    return [["track", String(index)], ...(known ? [["track's id", known[1]], ["category", known[2]]] : [])];
}

function flow(keyframe, flat) {
    if (!keyframe.flow || !keyframe.isOccupied(flat)) return [];
    const at = keyframe.flow.flats.indexOf(flat);
    const velocity = keyframe.flow.axes.map((axis) => (at < 0 ? 0 : axis[at]));
    if (velocity.some(Number.isNaN)) return [["flow", "not known"]];
    const speed = Math.hypot(...velocity).toFixed(2);
    return [["flow", `${velocity.map((v) => v.toFixed(2)).join(", ")} m/s (${speed})`]];
}
