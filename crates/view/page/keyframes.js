// The keyframes in the page, decoded when they are asked for.

import { countsOf, flowOf, numbersOf, partsOf } from "./decode.js";

export const NO_LABEL = 255;

/** So many decoded voxels are kept beside those of the keyframe that is shown. */
const KEPT_VOXELS = 8e6;

/** The keyframes of a scene. `textOf(id)` gives the text of an array. */
export class Keyframes {
    constructor(scene, textOf) {
        Object.assign(this, { scene, textOf, decoded: new Map() });
    }

    get length() {
        return this.scene.keyframes.length;
    }

    /** A keyframe with all its arrays but the counts, which `withCounts` adds. */
    get(at) {
        const found = this.decoded.get(at) ?? this.decode(at);
        this.decoded.delete(at);
        this.decoded.set(at, found);
        this.forget(at);
        return found;
    }

    async decode(at) {
        const keyframe = new Keyframe(this, at);
        await keyframe.decodeLabels();
        return keyframe;
    }

    /** Those that were not asked for longest go first. */
    forget(shown) {
        const { shape } = this.scene.keyframes[shown];
        const kept = Math.max(3, Math.floor(KEPT_VOXELS / (shape[0] * shape[1] * shape[2])));
        for (const at of this.decoded.keys()) {
            if (this.decoded.size <= kept) return;
            this.decoded.delete(at);
        }
    }
}

/** One keyframe: grids in flat order, z fastest. What there is not is undefined. */
class Keyframe {
    constructor(keyframes, at) {
        const about = keyframes.scene.keyframes[at];
        Object.assign(this, about, { keyframes, at, free: keyframes.scene.free });
        this.size = about.shape[0] * about.shape[1] * about.shape[2];
    }

    has(name) {
        return this.arrays.includes(name);
    }

    async decodeLabels() {
        const begun = performance.now();
        const names = ["semantics", "mask_lidar", "mask_camera", "instances", "camera_bits"];
        await Promise.all(names.filter((name) => this.has(name)).map(async (name) => {
            this[name] = numbersOf(await this.parts(name), this.shape);
        }));
        if (this.has("flow")) this.flow = flowOf(await this.parts("flow"), this.size);
        this.labels_ms = performance.now() - begun;
    }

    /** The same keyframe, with hits and crossings if there are any. */
    withCounts() {
        this.counted ??= this.decodeCounts();
        return this.counted;
    }

    async decodeCounts() {
        const begun = performance.now();
        const expected = { hits: (flat) => this.isOccupied(flat), crossings: (flat) => this.mask_lidar?.[flat] };
        for (const name of ["hits", "crossings"].filter((name) => this.has(name))) {
            this[name] = countsOf(await this.parts(name), this.shape, expected[name]);
        }
        this.counts_ms = performance.now() - begun;
        return this;
    }

    parts(name) {
        return partsOf(this.keyframes.textOf(`${this.at}/${name}`));
    }

    isOccupied(flat) {
        return this.semantics[flat] !== this.free && this.semantics[flat] !== NO_LABEL;
    }

    isObserved(flat) {
        return this.semantics[flat] !== NO_LABEL && (!this.mask_lidar || this.mask_lidar[flat] !== 0);
    }

    /** What a voxel is where nothing stands and nobody says that it was not observed. */
    emptyName() {
        return this.has("mask_lidar") ? "free" : "free or unobserved";
    }

    /** Whether cameras are known, and none sees the voxel. */
    isHidden(flat) {
        return this.hasCameras() && this.mask_camera[flat] === 0;
    }

    hasCameras() {
        this.seen ??= this.mask_camera !== undefined && this.mask_camera.some((seen) => seen !== 0);
        return this.seen;
    }
}
