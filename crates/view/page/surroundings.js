// What is not a label: the grid's outline and floor, axes, the ego's mark and its way.

import { maxOf } from "./voxels.js";

const LINE = 0x4a5361;
const FLOOR_LINE = 0x2b313b;
const INK = 0xe8ecf2;
const AXES = [0xe5706a, 0x7fc97f, 0x6aa5e5];
const WAY = 0x8fb7ff;
const STEP_M = 10;

/** Lines around the grid of a keyframe, as an object of the scene. */
export class Surroundings extends THREE.Group {
    show(keyframe) {
        const same = JSON.stringify([keyframe.min_m, keyframe.size_m, keyframe.shape, keyframe.heading_rad]);
        if (this.drawn !== same) {
            this.clear();
            this.add(floor(keyframe), outline(keyframe), ...axes());
            if (keyframe.heading_rad !== null) this.add(egoMark(keyframe.heading_rad));
            this.drawn = same;
        }
        this.drawWay(keyframe);
    }

    drawWay(keyframe) {
        if (this.way) this.remove(this.way);
        this.way = wayOf(keyframe);
        if (this.way) this.add(this.way);
    }
}

function segments(points, color, opacity = 1) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points.flat()), 3));
    const material = new THREE.LineBasicMaterial({ color, transparent: opacity < 1, opacity });
    return new THREE.LineSegments(geometry, material);
}

/** Lines each 10 m, counted from the ego. */
function floor(grid) {
    const [low, high] = [grid.min_m, maxOf(grid)];
    const points = [];
    for (const [axis, other] of [[0, 1], [1, 0]]) {
        for (let at = Math.ceil(low[axis] / STEP_M) * STEP_M; at <= high[axis]; at += STEP_M) {
            for (const end of [low[other], high[other]]) {
                const point = [0, 0, low[2]];
                [point[axis], point[other]] = [at, end];
                points.push(point);
            }
        }
    }
    return segments(points, FLOOR_LINE);
}

function outline(grid) {
    const [low, high] = [grid.min_m, maxOf(grid)];
    const corner = (bits) => [0, 1, 2].map((axis) => (bits & (1 << axis) ? high : low)[axis]);
    const points = [];
    for (let bits = 0; bits < 8; bits++) {
        for (const axis of [1, 2, 4]) if (!(bits & axis)) points.push(corner(bits), corner(bits | axis));
    }
    return segments(points, LINE);
}

function axes() {
    const end = (axis) => [0, 1, 2].map((other) => (other === axis ? 3 : 0));
    return AXES.map((color, axis) => segments([[0, 0, 0], end(axis)], color));
}

/** An arrowhead that points forward, drawn over all. */
function egoMark(heading_rad) {
    const shape = [[2.6, 0, 0], [-1.4, 1.5, 0], [-0.6, 0, 0], [2.6, 0, 0], [-0.6, 0, 0], [-1.4, -1.5, 0]];
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(shape.flat()), 3));
    const look = { color: INK, side: THREE.DoubleSide, transparent: true, opacity: 0.85, depthTest: false };
    const mark = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(look));
    mark.rotation.z = heading_rad;
    mark.renderOrder = 1;
    return mark;
}

/** Where the grid's frame stands at the other keyframes, seen from this one's. */
function wayOf({ keyframes, world_from_grid: here }) {
    const poses = keyframes.scene.keyframes.map(({ world_from_grid }) => world_from_grid);
    if (!here || poses.length < 2 || poses.some((pose) => !pose)) return null;
    const back = new THREE.Quaternion(...here.slice(3)).invert();
    const moved = (pose) => pose.slice(0, 3).map((metres, axis) => metres - here[axis]);
    const places = poses.map((pose) => new THREE.Vector3(...moved(pose)).applyQuaternion(back).toArray());
    const points = places.slice(1).flatMap((place, at) => [places[at], place]);
    return segments(points, WAY, 0.7);
}

/** Lines around the picked voxel, seen through all. */
export function frameOfPick() {
    const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(1.04, 1.04, 1.04));
    const frame = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0xffffff, depthTest: false }));
    frame.renderOrder = 2;
    frame.visible = false;
    return frame;
}
