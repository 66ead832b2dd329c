// Occupied voxels as lit cubes: the faces that nothing covers, six draws.

import { DIRECTIONS, facesBefore, facesOf, openCorners } from "./faces.js";
import { voxelAt } from "./voxels.js";

const LIGHT = [0.8, 0.74, 0.87, 0.68, 1.0, 0.5];

const VERTEX = `
attribute vec3 voxel;
attribute vec4 tint;
uniform vec3 min_m;
uniform vec3 size_m;
uniform float light;
varying vec3 color;
varying vec4 corners;
varying vec2 at;
void main() {
    color = tint.rgb * light;
    float open = floor(tint.a * 255.0 + 0.5);
    corners = mod(floor(open / vec4(1.0, 4.0, 16.0, 64.0)), 4.0) / 3.0;
    at = uv;
    vec3 p_m = min_m + (voxel + position) * size_m;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p_m, 1.0);
}`;

// Edges are drawn where a voxel is large enough for them.
const FRAGMENT = `
varying vec3 color;
varying vec4 corners;
varying vec2 at;
void main() {
    float open = mix(mix(corners.x, corners.y, at.x), mix(corners.w, corners.z, at.x), at.y);
    vec2 per_pixel = fwidth(at);
    vec2 from_edge = min(at, 1.0 - at) / per_pixel;
    float edge = 1.0 - smoothstep(0.4, 1.4, min(from_edge.x, from_edge.y));
    float room = 1.0 - smoothstep(0.06, 0.22, max(per_pixel.x, per_pixel.y));
    gl_FragColor = vec4(color * (0.62 + 0.38 * open) * (1.0 - 0.24 * edge * room), 1.0);
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
        this.children.forEach((mesh, at) => this.fill(mesh, DIRECTIONS[at], this.faces[at].flats, { shown, colorOf }));
    }

    fill(mesh, direction, flats, { shown, colorOf }) {
        const { shape } = this.keyframe;
        const voxels = new Uint16Array(4 * flats.length);
        const tints = new Uint8Array(4 * flats.length);
        flats.forEach((flat, at) => {
            const voxel = voxelAt(shape, flat);
            voxels.set(voxel, 4 * at);
            tints.set(colorOf(flat), 4 * at);
            tints[4 * at + 3] = openCorners(shown, shape, direction, voxel);
        });
        const geometry = quad(direction);
        geometry.setAttribute("voxel", new THREE.InstancedBufferAttribute(voxels, 4));
        geometry.setAttribute("tint", new THREE.InstancedBufferAttribute(tints, 4, true));
        mesh.geometry.dispose();
        mesh.geometry = geometry;
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

/** One face of the unit cube, turning counter-clockwise as one looks at it; u and v run along the next axes. */
function quad({ axis, sign }) {
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    const positions = corners.flatMap(([u, v]) => {
        const corner = [0, 0, 0];
        [corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]] = [sign > 0 ? 1 : 0, u, v];
        return corner;
    });
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(corners.flat()), 2));
    geometry.setIndex(sign > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2]);
    return geometry;
}
