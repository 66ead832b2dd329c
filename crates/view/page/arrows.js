// Flow: where things will be in half a second.

import { centreOf, voxelAt } from "./voxels.js";

const AHEAD_S = 0.5;
const SLOWEST_MPS = 0.3;
const LIFT_M = 0.4;
const COLOR = 0xfff3c4;
/** Where no tracks are known, voxels of a block this wide share an arrow. */
const BLOCK_M = 3;

/** The arrows of a keyframe, as an object of the scene: two draws. */
export class Arrows extends THREE.Group {
    constructor() {
        super();
        const shaft = new THREE.CylinderGeometry(0.055, 0.055, 1, 8).translate(0, 0.5, 0);
        const head = new THREE.ConeGeometry(0.24, 0.9, 12).translate(0, -0.45, 0);
        this.parts = [shaft, head];
    }

    /** Arrows of the voxels that are shown. */
    show(keyframe, shown) {
        this.clear();
        const arrows = keyframe.flow ? arrowsOf(keyframe, shown) : [];
        if (arrows.length === 0) return;
        const material = new THREE.MeshBasicMaterial({ color: COLOR });
        const [shafts, heads] = this.parts.map((part) => new THREE.InstancedMesh(part, material, arrows.length));
        arrows.forEach(({ from, flow }, at) => {
            const [start, way] = [new THREE.Vector3(...from), new THREE.Vector3(...flow).multiplyScalar(AHEAD_S)];
            const turn = new THREE.Quaternion().setFromUnitVectors(UP, way.clone().normalize());
            const body = new THREE.Vector3(1, Math.max(way.length() - 0.8, 0.05), 1);
            shafts.setMatrixAt(at, new THREE.Matrix4().compose(start, turn, body));
            heads.setMatrixAt(at, new THREE.Matrix4().compose(start.clone().add(way), turn, ONE));
        });
        [shafts, heads].forEach((mesh) => (mesh.frustumCulled = false));
        this.add(shafts, heads);
    }
}

const UP = new THREE.Vector3(0, 1, 0);
const ONE = new THREE.Vector3(1, 1, 1);

/** Mean place, on top, and mean flow of the voxels of each track that move. */
function arrowsOf(keyframe, shown) {
    const groups = new Map();
    keyframe.flow.flats.forEach((flat, at) => {
        const flow = keyframe.flow.axes.map((axis) => axis[at]);
        if (!shown[flat] || !(Math.hypot(...flow) >= SLOWEST_MPS)) return;
        const centre = centreOf(keyframe, voxelAt(keyframe.shape, flat));
        const key = keyframe.instances?.[flat] || centre.map((c) => Math.floor(c / BLOCK_M)).join();
        const group = groups.get(key) ?? { count: 0, sum: [0, 0, 0, 0, 0], top: -Infinity };
        [...flow, centre[0], centre[1]].forEach((value, i) => (group.sum[i] += value));
        group.count++;
        group.top = Math.max(group.top, centre[2]);
        groups.set(key, group);
    });
    return [...groups.values()].map(({ count, sum, top }) => {
        const [vx, vy, vz, x, y] = sum.map((value) => value / count);
        return { from: [x, y, top + LIFT_M], flow: [vx, vy, vz] };
    });
}
