// Voxels without a cube (free, unobserved) as faint points.

import { keptBySlice } from "./voxels.js";

/** More points are thinned out: every second is shown, or every fourth, ... */
export const MOST_POINTS = 1.5e6;

const VERTEX_OF_POINT = `
attribute vec4 tint;
uniform vec3 min_m;
uniform vec3 size_m;
uniform float pixels;
varying vec4 color;
void main() {
    color = tint;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(min_m + (position + 0.5) * size_m, 1.0);
    gl_PointSize = clamp(0.16 * size_m.x * pixels / gl_Position.w, 1.0, 12.0);
}`;

const FRAGMENT_OF_POINT = `
varying vec4 color;
void main() {
    gl_FragColor = color;
}`;

/** Points of a keyframe, as an object of the scene: one draw. */
export class VoxelPoints extends THREE.Points {
    constructor() {
        const uniforms = { min_m: { value: [] }, size_m: { value: [] }, pixels: { value: 1 } };
        const shaders = { vertexShader: VERTEX_OF_POINT, fragmentShader: FRAGMENT_OF_POINT, uniforms };
        super(new THREE.BufferGeometry(), new THREE.ShaderMaterial({ ...shaders, transparent: true, depthWrite: false }));
        this.visible = false;
        this.frustumCulled = false;
    }

    /** Shows the voxels that `has(flat)`, as far as the slice leaves them; gives every how many-th is shown. */
    show(keyframe, slice, has, colorOf) {
        const flats = flatsOf(keyframe, slice, has);
        const every = 2 ** Math.max(0, Math.ceil(Math.log2(flats.length / MOST_POINTS)));
        const voxels = new Uint16Array(4 * Math.ceil(flats.length / every));
        const tints = new Uint8Array(voxels.length);
        for (let from = 0, to = 0; from < flats.length; from += every, to += 4) {
            const flat = flats[from];
            const [, ny, nz] = keyframe.shape;
            [voxels[to], voxels[to + 1], voxels[to + 2]] = [Math.floor(flat / (ny * nz)), Math.floor(flat / nz) % ny, flat % nz];
            tints.set(colorOf(flat), to);
        }
        this.geometry.dispose();
        this.geometry = new THREE.BufferGeometry();
        this.geometry.setAttribute("position", new THREE.BufferAttribute(voxels, 4));
        this.geometry.setAttribute("tint", new THREE.BufferAttribute(tints, 4, true));
        this.material.uniforms.min_m.value = keyframe.min_m;
        this.material.uniforms.size_m.value = keyframe.size_m;
        return every;
    }
}

function flatsOf({ shape, size }, slice, has) {
    const flats = new Uint32Array(size);
    const kept = keptBySlice(shape, slice);
    let [flat, count] = [0, 0];
    for (let x = 0; x < shape[0]; x++) {
        for (let y = 0; y < shape[1]; y++) {
            for (let z = 0; z < shape[2]; z++, flat++) {
                if (kept[0][x] & kept[1][y] & kept[2][z] && has(flat)) flats[count++] = flat;
            }
        }
    }
    return flats.subarray(0, count);
}
