// Arrays as `src/page/` makes them small, undone. All of it is exact but flow, which is in steps of 1 cm/s.

const PLAIN = 16;
const TOKEN_BITS = 3;
const FLOW_STEP_MPS = 0.01;
const FLOW_UNKNOWN = -32768;

/** The deflated parts of an array, inflated. */
export async function partsOf(text) {
    const bytes = fromBase64(text);
    const head = new DataView(bytes.buffer);
    const count = head.getUint32(0, true);
    const parts = [];
    let at = 4 * (count + 1);
    for (let part = 1; part <= count; part++) {
        const length = head.getUint32(4 * part, true);
        parts.push(inflate(bytes.subarray(at, at + length)));
        at += length;
    }
    return Promise.all(parts);
}

function fromBase64(text) {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const characters = atob(text);
    const bytes = new Uint8Array(characters.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
    return bytes;
}

async function inflate(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** A grid of names: a part a byte of its numbers, each xor the voxel one step back along x. */
export function numbersOf(planes, shape) {
    const slab = shape[1] * shape[2];
    for (const plane of planes) {
        for (let flat = slab; flat < plane.length; flat++) plane[flat] ^= plane[flat - slab];
    }
    if (planes.length === 1) return planes[0];
    const [low, high] = planes;
    const numbers = new Uint16Array(low.length);
    for (let flat = 0; flat < numbers.length; flat++) numbers[flat] = low[flat] | (high[flat] << 8);
    return numbers;
}

/** A grid of counts. `expected(flat)` says where counts are likely. */
export function countsOf([surprises, ...rest], shape, expected) {
    const [nx, ny, nz] = shape;
    const counts = new Uint16Array(nx * ny * nz);
    const slab = ny * nz;
    const bits = new BitReader(rest.pop());
    const [streams, next] = [rest, new Uint32Array(rest.length)];
    for (let flat = 0; flat < counts.length; flat++) {
        const isSurprise = (surprises[flat >> 3] >> (flat & 7)) & 1;
        if (isSurprise === (expected(flat) ? 1 : 0)) continue;
        const hasX = flat >= slab;
        const hasY = flat % slab >= nz;
        const x = hasX ? counts[flat - slab] : 0;
        const y = hasY ? counts[flat - nz] : 0;
        const both = hasX && hasY ? counts[flat - slab - nz] : 0;
        const plane = Math.min(Math.max(x + y - both, Math.min(x, y)), Math.max(x, y));
        const stream = (33 - Math.clz32(Math.max(x, y, both))) >> 1;
        counts[flat] = plane + unzigzag(errorOf(streams[stream][next[stream]++], bits));
    }
    return counts;
}

function errorOf(token, bits) {
    if (token < PLAIN) return token;
    const rest = ((token - PLAIN) >> TOKEN_BITS) + 1;
    const highest = (1 << TOKEN_BITS) | (token & ((1 << TOKEN_BITS) - 1));
    return (highest << rest) | bits.read(rest);
}

function unzigzag(value) {
    return (value >>> 1) ^ -(value & 1);
}

/** Flow: the voxels where it is not 0, in their order, and its x, y, z there; NaN where it is not known. */
export function flowOf([places, ...steps], length) {
    const flats = new Uint32Array(steps[0].length);
    for (let flat = 0, at = 0; flat < length; flat++) {
        if ((places[flat >> 3] >> (flat & 7)) & 1) flats[at++] = flat;
    }
    const axes = [0, 1, 2].map((axis) => velocitiesOf(steps[2 * axis], steps[2 * axis + 1]));
    return { flats, axes };
}

function velocitiesOf(low, high) {
    const velocities = new Float32Array(low.length);
    let now = 0;
    for (let at = 0; at < low.length; at++) {
        now = ((now + unzigzag(low[at] | (high[at] << 8))) << 16) >> 16;
        velocities[at] = now === FLOW_UNKNOWN ? NaN : now * FLOW_STEP_MPS;
    }
    return velocities;
}

/** Bits in a row, the first in the lowest place of the first byte. */
class BitReader {
    constructor(bytes) {
        this.bytes = bytes;
        this.at = 0;
    }

    read(count) {
        let value = 0;
        for (let got = 0; got < count; got++, this.at++) {
            value |= ((this.bytes[this.at >> 3] >> (this.at & 7)) & 1) << got;
        }
        return value;
    }
}
