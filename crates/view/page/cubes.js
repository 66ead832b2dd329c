// Occupied voxels as lit cubes: the faces that nothing covers, six draws.

import { DIRECTIONS, facesBefore, facesOf } from "./faces.js";
import { voxelAt } from "./voxels.js";

const LIGHT = [0.8, 0.74, 0.87, 0.68, 1.0, 0.5];

const VERTEX = `
attribute vec3 voxel;
attribute vec3 tint;
uniform vec3 min_m;
uniform vec3 size_m;
uniform float light;
varying vec3 color;
varying vec2 at;
void main() {
    color = tint * light;
    at = uv;
    vec3 p_m = min_m + (voxel + position) * size_m;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p_m, 1.0);
}`;

// Edges are drawn where a voxel is large enough for them.
const FRAGMENT = `
varying vec3 color;
varying vec2 at;
void main() {
    vec2 per_pixel = fwidth(at);
    vec2 from_edge = min(at, 1.0 - at) / per_pixel;
    float edge = 1.0 - smoothstep(0.4, 1.4, min(from_edge.x, from_edge.y));
    float room = 1.0 - smoothstep(0.06, 0.22, max(per_pixel.x, per_pixel.y));
    gl_FragColor = vec4(color * (1.0 - 0.26 * edge * room), 1.0);
}`;

/** The cubes of a keyframe, as an object of the scene. */
export class Cubes extends THREE.Group {
    constructor() {
        super();
        this.grid = { min_m: { value: new THREE.Vector3() }, size_m: { value: new THREE.Vector3() } };
        DIRECTIONS.forEach((direction, at) => this.add(this.meshOf(direction, LIGHT[at])));
    }

    meshOf(direction, light) {
        const uniforms = { ...this.grid, light: { value: light } };
        const shaders = { vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms };
        const mesh = new THREE.Mesh(quad(direction), new THREE.ShaderMaterial(shaders));
        mesh.frustumCulled = false;
        return mesh;
    }

    /** Shows voxels of a keyframe. `colorOf(flat)` is red, green and blue. */
    show(keyframe, shown, colorOf) {
        this.grid.min_m.value.fromArray(keyframe.min_m);
        this.grid.size_m.value.fromArray(keyframe.size_m);
        this.keyframe = keyframe;
        this.faces = facesOf(shown, keyframe.shape);
        this.children.forEach((mesh, at) => this.fill(mesh, this.faces[at].flats));
        this.recolor(colorOf);
    }

    fill(mesh, flats) {
        const voxels = new Uint16Array(4 * flats.length);
        flats.forEach((flat, at) => voxels.set(voxelAt(this.keyframe.shape, flat), 4 * at));
        const geometry = quad(DIRECTIONS[this.children.indexOf(mesh)]);
        const [place, tint] = [voxels, new Uint8Array(4 * flats.length)];
        geometry.setAttribute("voxel", new THREE.InstancedBufferAttribute(place, 4));
        geometry.setAttribute("tint", new THREE.InstancedBufferAttribute(tint, 4, true));
        mesh.geometry.dispose();
        mesh.geometry = geometry;
    }

    /** The same voxels in other colours. */
    recolor(colorOf) {
        const colors = new Map();
        const known = (flat) => colors.get(flat) ?? (colors.set(flat, colorOf(flat)), colors.get(flat));
        this.children.forEach((mesh, direction) => {
            const { tint } = mesh.geometry.attributes;
            this.faces[direction].flats.forEach((flat, at) => tint.array.set(known(flat), 4 * at));
            tint.needsUpdate = true;
        });
    }

    /** Leaves out the faces that turn their back to the eye. */
    faceEye(eye_m) {
        const eye = eye_m.toArray();
        this.children.forEach((mesh, at) => {
            const { axis } = DIRECTIONS[at];
            const { min_m, size_m } = this.keyframe;
            const along = (eye[axis] - min_m[axis]) / size_m[axis];
            mesh.geometry.instanceCount = facesBefore(this.faces[at], DIRECTIONS[at], along);
            mesh.visible = mesh.geometry.instanceCount > 0;
        });
    }
}

/** One face of the unit cube, turning counter-clockwise as one looks at it. */
function quad({ axis, sign }) {
    const [a, b] = sign > 0 ? [(axis + 1) % 3, (axis + 2) % 3] : [(axis + 2) % 3, (axis + 1) % 3];
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    const positions = corners.flatMap(([u, v]) => {
        const corner = [0, 0, 0];
        [corner[axis], corner[a], corner[b]] = [sign > 0 ? 1 : 0, u, v];
        return corner;
    });
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(corners.flat()), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    return geometry;
}
