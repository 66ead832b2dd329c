// The parts of the page that need no browser, against slow and obvious ones.

import assert from "node:assert/strict";

import { DIRECTIONS, facesBefore, facesOf, keepNearest } from "../../crates/view/page/faces.js";
import { Keyframes } from "../../crates/view/page/keyframes.js";
import { firstOnRay } from "../../crates/view/page/pick.js";

/** What the page decodes is what it was made of, voxel by voxel; how many numbers were compared. */
export async function checkDecoded(html, expected) {
    const textOf = (id) => html.split(`id="${id}">`)[1].split("<")[0];
    const keyframes = new Keyframes(JSON.parse(textOf("scene")), textOf);
    assert.equal(keyframes.length, expected.keyframes.length);
    let compared = 0;
    for (const [at, wanted] of expected.keyframes.entries()) {
        const keyframe = await keyframes.get(at).then((keyframe) => keyframe.withCounts());
        assert.equal(keyframe.token, wanted.token);
        for (const name of ["semantics", "mask_lidar", "mask_camera", "instances", "camera_bits", "hits", "crossings"]) {
            assert.deepEqual([...keyframe[name]], wanted[name], `${name} of ${wanted.token}`);
            compared += wanted[name].length;
        }
        compared += checkFlow(keyframe, wanted.flow);
    }
    return compared;
}

/** Flow is in steps of 1 cm/s; null where it is not known. */
function checkFlow({ flow, size }, wanted) {
    const decoded = new Map([...flow.flats].map((flat, at) => [flat, flow.axes.map((axis) => axis[at])]));
    for (let flat = 0; flat < size; flat++) {
        const found = decoded.get(flat) ?? [0, 0, 0];
        for (let axis = 0; axis < 3; axis++) {
            const velocity = wanted[3 * flat + axis];
            if (velocity === null) assert.ok(Number.isNaN(found[axis]));
            else assert.ok(Math.abs(found[axis] - velocity) <= 0.00501, `${found[axis]} for ${velocity}`);
        }
    }
    return 3 * size;
}

/** Each face between a shown voxel and one that is not is there exactly once, and seen from its side. */
export function checkFaces({ shape, free, keyframes }) {
    const shown = Uint8Array.from(keyframes[0].semantics, (id) => (id === free ? 0 : 1));
    const found = facesOf(shown, shape);
    const inside = (voxel) => voxel.every((at, axis) => at >= 0 && at < shape[axis]);
    let faces = 0;
    DIRECTIONS.forEach((direction, at) => {
        const { axis, sign } = direction;
        const wanted = [];
        shown.forEach((isShown, flat) => {
            const beside = voxelAt(shape, flat);
            beside[axis] += sign;
            if (isShown && !(inside(beside) && shown[flatOf(shape, beside)])) wanted.push(flat);
        });
        assert.deepEqual([...found[at].flats].sort((a, b) => a - b), wanted);
        for (let eye = -1.5; eye <= shape[axis] + 2; eye += 0.25) {
            const isBefore = (flat) => sign * (eye - (voxelAt(shape, flat)[axis] + (sign > 0 ? 1 : 0))) > 0;
            const upTo = facesBefore(found[at], direction, eye);
            assert.equal(upTo, wanted.filter(isBefore).length, `axis ${axis}, sign ${sign}, eye ${eye}`);
            assert.ok([...found[at].flats.subarray(0, upTo)].every(isBefore));
        }
        faces += wanted.length;
    });
    assert.ok(faces > 1000);
    return { faces, kept: checkNearest(shown, shape, faces) };
}

/** As many of the nearest voxels are kept as faces are allowed. */
function checkNearest(shown, shape, faces) {
    const centre = [Math.floor(shape[0] / 2), Math.floor(shape[1] / 2)];
    assert.equal(keepNearest(shown.slice(), shape, centre, faces), null);
    const kept = shown.slice();
    const reach = keepNearest(kept, shape, centre, faces / 2);
    const ring = (flat) => Math.max(...[0, 1].map((axis) => Math.abs(voxelAt(shape, flat)[axis] - centre[axis])));
    kept.forEach((isKept, flat) => assert.equal(isKept === 1, shown[flat] === 1 && ring(flat) <= reach));
    return kept.reduce((sum, isKept) => sum + isKept, 0);
}

/** Rays find the voxel whose box they enter first of all. */
export function checkRays({ shape, free, keyframes }) {
    const stops = (flat) => keyframes[0].semantics[flat] !== free;
    const random = randomNumbers(7);
    let [hits, misses] = [0, 0];
    for (let ray = 0; ray < 400; ray++) {
        const eye = shape.map((n) => (random() * 2 - 0.5) * n);
        const direction = [0, 1, 2].map((axis) => random() * shape[axis] - eye[axis]);
        const found = firstOnRay(shape, eye, direction, stops);
        const wanted = firstBox(shape, eye, direction, stops);
        assert.equal(found?.flat, wanted?.flat);
        if (found) hits++;
        else misses++;
    }
    assert.ok(hits > 100 && misses > 20, `${hits} ${misses}`);
    return { rays: { hits, misses } };
}

/** The same by asking each voxel's box. */
function firstBox(shape, eye, direction, stops) {
    let first = null;
    for (let flat = 0; flat < shape[0] * shape[1] * shape[2]; flat++) {
        if (!stops(flat)) continue;
        let [enter, leave] = [0, Infinity];
        voxelAt(shape, flat).forEach((at, axis) => {
            const ends = [at, at + 1].map((face) => (face - eye[axis]) / direction[axis]);
            enter = Math.max(enter, Math.min(...ends));
            leave = Math.min(leave, Math.max(...ends));
        });
        if (enter < leave && enter < (first?.enter ?? Infinity)) first = { flat, enter };
    }
    return first;
}

/** Numbers from 0 to 1, the same each time (xorshift, Marsaglia 2003). */
function randomNumbers(seed) {
    let state = seed;
    return () => {
        for (const shift of [13, -17, 5]) state ^= shift > 0 ? state << shift : state >>> -shift;
        return (state >>> 0) / 2 ** 32;
    };
}

function voxelAt([, ny, nz], flat) {
    return [Math.floor(flat / (ny * nz)), Math.floor(flat / nz) % ny, flat % nz];
}

function flatOf([, ny, nz], [x, y, z]) {
    return (x * ny + y) * nz + z;
}
