// One layer of voxels as a sheet: what is free and what nobody observed can be looked at in it.

import { flatOf } from "./voxels.js";

/** The sheet, as an object of the scene. */
export class Slice extends THREE.Mesh {
    constructor() {
        const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true });
        super(new THREE.BufferGeometry(), material);
        this.visible = false;
        this.frustumCulled = false;
    }

    /** Shows layer `at` across `axis`. `colorOf(flat)` is red, green, blue and opacity, 0 to 255. */
    show(keyframe, { axis, at }, colorOf) {
        this.visible = axis !== null;
        if (!this.visible) return;
        const [a, b] = [0, 1, 2].filter((other) => other !== axis);
        this.geometry.dispose();
        this.geometry = sheet(keyframe, axis, at, a, b);
        this.material.map?.dispose();
        this.material.map = texture(keyframe, axis, at, a, b, colorOf);
        this.material.needsUpdate = true;
    }
}

function sheet({ min_m, size_m, shape }, axis, at, a, b) {
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    const positions = corners.flatMap(([u, v]) => {
        const corner = [0, 0, 0];
        corner[axis] = min_m[axis] + (at + 0.5) * size_m[axis];
        corner[a] = min_m[a] + u * shape[a] * size_m[a];
        corner[b] = min_m[b] + v * shape[b] * size_m[b];
        return corner;
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(corners.flat()), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    return geometry;
}

function texture({ shape }, axis, at, a, b, colorOf) {
    const pixels = new Uint8Array(4 * shape[a] * shape[b]);
    const voxel = [0, 0, 0];
    voxel[axis] = at;
    for (let row = 0; row < shape[b]; row++) {
        for (let column = 0; column < shape[a]; column++) {
            [voxel[a], voxel[b]] = [column, row];
            pixels.set(colorOf(flatOf(shape, voxel)), 4 * (row * shape[a] + column));
        }
    }
    const map = new THREE.DataTexture(pixels, shape[a], shape[b], THREE.RGBAFormat);
    map.colorSpace = THREE.SRGBColorSpace;
    map.magFilter = map.minFilter = THREE.NearestFilter;
    map.needsUpdate = true;
    return map;
}
