// Where voxels stand, and which are shown.

/** Place of a voxel in flat arrays: z fastest. */
export function flatOf([, ny, nz], [x, y, z]) {
    return (x * ny + y) * nz + z;
}

/** The voxel at a place of flat arrays. */
export function voxelAt([, ny, nz], flat) {
    return [Math.floor(flat / (ny * nz)), Math.floor(flat / nz) % ny, flat % nz];
}

/** Centre of a voxel in the grid frame, metres. */
export function centreOf({ min_m, size_m }, voxel) {
    return voxel.map((at, axis) => min_m[axis] + (at + 0.5) * size_m[axis]);
}

/** Upper corner of the grid, metres. */
export function maxOf({ min_m, size_m, shape }) {
    return shape.map((n, axis) => min_m[axis] + n * size_m[axis]);
}

/** How many voxels are of each class, free, and unobserved. */
export function tally(keyframe) {
    const counts = { classes: new Uint32Array(256), free: 0, unobserved: 0 };
    for (let flat = 0; flat < keyframe.size; flat++) {
        if (keyframe.isOccupied(flat)) counts.classes[keyframe.semantics[flat]]++;
        else if (keyframe.isObserved(flat)) counts.free++;
        else counts.unobserved++;
    }
    return counts;
}

/**
 * 1 where an occupied voxel is shown. `view` has `off` (classes that are not), `cameras` and `lidar`
 * (`only` leaves out what they do not see), and the `slice`, which keeps what is below or beyond it.
 */
export function shownVoxels(keyframe, view) {
    const { shape, semantics } = keyframe;
    const shown = new Uint8Array(keyframe.size);
    const isOn = Uint8Array.from({ length: 256 }, (_, id) => (view.off.has(id) ? 0 : 1));
    const left = keptBySlice(shape, view.slice);
    let flat = 0;
    for (let x = 0; x < shape[0]; x++) {
        for (let y = 0; y < shape[1]; y++) {
            for (let z = 0; z < shape[2]; z++, flat++) {
                if (!isOn[semantics[flat]] || !keyframe.isOccupied(flat)) continue;
                shown[flat] = left[0][x] & left[1][y] & left[2][z];
            }
        }
    }
    if (view.cameras === "only") leaveOut(shown, (at) => keyframe.isHidden(at));
    if (view.lidar === "only") leaveOut(shown, (at) => !keyframe.isObserved(at));
    return shown;
}

/** For each axis, 1 where a slice leaves voxels: below it, or beyond it as one looks along x or y. */
export function keptBySlice(shape, slice) {
    const all = shape.map((n) => new Uint8Array(n).fill(1));
    if (slice.axis === 2) all[2].fill(0, slice.at);
    else if (slice.axis !== null) all[slice.axis].fill(0, 0, slice.at + 1);
    return all;
}

function leaveOut(shown, isOut) {
    for (let flat = 0; flat < shown.length; flat++) {
        if (shown[flat] && isOut(flat)) shown[flat] = 0;
    }
}
