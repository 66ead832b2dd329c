// The faces of shown voxels that nothing covers.

/** The six directions in which faces look: along axis 0, 1, 2, up or down. */
export const DIRECTIONS = [0, 1, 2].flatMap((axis) => [1, -1].map((sign) => ({ axis, sign })));

/**
 * The faces of voxels whose neighbour in a direction is not shown: for each of DIRECTIONS the `flats` of
 * their voxels, those first that most eyes see. An eye sees the faces of the first `upTo[n]` alone, where n
 * is the number of layers whose face it is in front of: the rest turns its back.
 */
export function facesOf(shown, shape) {
    const strides = [shape[1] * shape[2], shape[2], 1];
    const walk = (each) => eachFace(shown, shape, strides, each);
    const layers = DIRECTIONS.map(({ axis }) => new Uint32Array(shape[axis] + 1));
    walk((direction, layer) => layers[direction][layer + 1]++);
    layers.forEach((upTo) => upTo.forEach((count, n) => n > 0 && (upTo[n] = upTo[n - 1] + count)));
    const faces = layers.map((upTo) => ({ flats: new Uint32Array(upTo.at(-1)), upTo }));
    const next = layers.map((upTo) => upTo.slice());
    walk((direction, layer, flat) => (faces[direction].flats[next[direction][layer]++] = flat));
    return faces;
}

/**
 * Takes away the shown voxels that are farthest from `centre` (x, y), so that at most `most` faces are left:
 * gives how many voxels away the farthest may be that stay, or null if all may.
 */
export function keepNearest(shown, shape, centre, most) {
    const strides = [shape[1] * shape[2], shape[2], 1];
    const ring = (flat) => {
        const [x, y] = [Math.floor(flat / strides[0]), Math.floor(flat / strides[1]) % shape[1]];
        return Math.max(Math.abs(x - centre[0]), Math.abs(y - centre[1]));
    };
    const faces = new Uint32Array(shape[0] + shape[1] + Math.abs(centre[0]) + Math.abs(centre[1]) + 1);
    eachFace(shown, shape, strides, (direction, layer, flat) => faces[ring(flat)]++);
    let [reach, sum] = [0, 0];
    while (reach < faces.length && sum + faces[reach] <= most) sum += faces[reach++];
    if (reach === faces.length) return null;
    shown.forEach((isShown, flat) => isShown && ring(flat) >= reach && (shown[flat] = 0));
    return Math.max(reach - 1, 0);
}

/** Layers are counted in the order in which an eye that comes from behind the faces passes them. */
function eachFace(shown, shape, strides, each) {
    const voxel = [0, 0, 0];
    for (let flat = 0; flat < shown.length; flat++) {
        if (!shown[flat]) continue;
        voxel[0] = Math.floor(flat / strides[0]);
        voxel[1] = Math.floor(flat / strides[1]) % shape[1];
        voxel[2] = flat % shape[2];
        for (let axis = 0; axis < 3; axis++) {
            const [at, last] = [voxel[axis], shape[axis] - 1];
            if (at === last || !shown[flat + strides[axis]]) each(2 * axis, at, flat);
            if (at === 0 || !shown[flat - strides[axis]]) each(2 * axis + 1, last - at, flat);
        }
    }
}

/**
 * How open the corners of a face are, 0 to 3 each, two bits a corner: what stands beside the air in front
 * of it keeps light away. Corners turn with the axes after the face's own: (0, 0), (1, 0), (1, 1), (0, 1).
 */
export function openCorners(shown, shape, { axis, sign }, voxel) {
    const stands = (a, b) => standsBeside(shown, shape, voxel, axis, [sign, a, b]);
    const [left, right, below, above] = [stands(-1, 0), stands(1, 0), stands(0, -1), stands(0, 1)];
    const open = (side, other, a, b) => (side && other ? 0 : 3 - side - other - stands(a, b));
    const corners = [open(left, below, -1, -1), open(right, below, 1, -1), open(right, above, 1, 1), open(left, above, -1, 1)];
    return corners.reduce((bits, corner, at) => bits | (corner << (2 * at)), 0);
}

function standsBeside(shown, shape, voxel, axis, steps) {
    const beside = [0, 0, 0];
    for (let i = 0; i < 3; i++) {
        const along = (axis + i) % 3;
        beside[along] = voxel[along] + steps[i];
        if (beside[along] < 0 || beside[along] >= shape[along]) return 0;
    }
    return shown[(beside[0] * shape[1] + beside[1]) * shape[2] + beside[2]];
}

/** How many of a direction's faces an eye may see, that stands at `eye` in voxel units along its axis. */
export function facesBefore({ upTo }, { sign }, eye) {
    const layers = upTo.length - 1;
    const inFront = sign > 0 ? Math.ceil(eye) - 1 : layers - 1 - Math.floor(eye);
    return upTo[Math.min(Math.max(inFront, 0), layers)];
}
