// Which voxel is under a ray.

/**
 * The first voxel that `stops(flat)`, on the ray from `eye` along `direction`, both in voxel units: its
 * place in flat arrays and how far along the ray its near face is; null if there is none.
 * Walked face by face (Amanatides & Woo 1987).
 */
export function firstOnRay(shape, eye, direction, stops) {
    const span = spanInside(shape, eye, direction);
    if (!span) return null;
    let along = span[0];
    const inside = (axis) => Math.floor(eye[axis] + (along + 1e-9) * direction[axis]);
    const voxel = [0, 1, 2].map((axis) => Math.min(Math.max(inside(axis), 0), shape[axis] - 1));
    const step = direction.map(Math.sign);
    const faceAt = (axis) => (voxel[axis] + (step[axis] > 0 ? 1 : 0) - eye[axis]) / direction[axis];
    const next = [0, 1, 2].map((axis) => (step[axis] === 0 ? Infinity : faceAt(axis)));
    for (;;) {
        const flat = (voxel[0] * shape[1] + voxel[1]) * shape[2] + voxel[2];
        if (stops(flat)) return { flat, along };
        const axis = next.indexOf(Math.min(...next));
        along = next[axis];
        voxel[axis] += step[axis];
        if (voxel[axis] < 0 || voxel[axis] >= shape[axis] || along > span[1]) return null;
        next[axis] = faceAt(axis);
    }
}

/** From where to where a ray runs inside the grid; null if it never does. */
function spanInside(shape, eye, direction) {
    let [enter, leave] = [0, Infinity];
    for (let axis = 0; axis < 3; axis++) {
        const ends = [0, shape[axis]].map((face) => (face - eye[axis]) / direction[axis]);
        if (direction[axis] === 0) {
            if (eye[axis] < 0 || eye[axis] >= shape[axis]) return null;
        } else {
            enter = Math.max(enter, Math.min(...ends));
            leave = Math.min(leave, Math.max(...ends));
        }
    }
    return enter < leave ? [enter, leave] : null;
}
