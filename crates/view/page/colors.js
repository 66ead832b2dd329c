// What colour a voxel has, by what one wants to see.

export const PAPER = [27, 31, 38];
const HIDDEN = [54, 60, 71];
const FREE = [88, 97, 112];
const SEEN_FREE = [150, 163, 184];
const UNOBSERVED_POINT = [150, 96, 110, 70];
const UNOBSERVED = [20, 23, 29];
export const UNNAMED = [120, 120, 120];
const NOTHING = [58, 64, 75];
/** Viridis at nine even steps. */
const RAMP = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"]
    .map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));

/** `a` with a share (0 to 1) of `b` in it. */
export function mix(a, b, share) {
    return a.map((channel, i) => Math.round(channel + (b[i] - channel) * share));
}

/** The colour at a share (0 to 1) of the ramp. */
export function ramp(share) {
    const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
    const low = Math.min(Math.floor(at), RAMP.length - 2);
    return mix(RAMP[low], RAMP[low + 1], at - low);
}

/** Share of the ramp of a count, on a logarithmic scale from 1 to `most`. */
export function logShare(count, most) {
    return Math.log(Math.max(count, 1)) / Math.log(Math.max(most, 2));
}

/** A colour of its own for each track, spread around the circle. */
export function trackColor(index) {
    if (index === 0) return NOTHING;
    const hue = (index * 137.508) % 360;
    const channel = (n) => {
        const k = (n + hue / 30) % 12;
        return Math.round(255 * (0.6 - 0.35 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
    };
    return [channel(0), channel(8), channel(4)];
}

/**
 * The ways to colour a keyframe's voxels: a key, a name, the array that it needs, and `of(flat)`.
 * Ways with `most` have a colour bar from 1 to that count.
 */
export function waysToColor(scene, keyframe, view) {
    const classes = scene.colors[view.colors];
    const byCount = (name) => (flat) =>
        keyframe[name][flat] === 0 ? NOTHING : ramp(logShare(keyframe[name][flat], scene.most[name]));
    const byClass = (flat) => classes[keyframe.semantics[flat]] ?? UNNAMED;
    const layers = Math.max(keyframe.shape[2] - 1, 1);
    const byHeight = (flat) => ramp((flat % keyframe.shape[2]) / layers);
    const byCamera = (bit) => (flat) => ((keyframe.camera_bits[flat] >> bit) & 1 ? byClass(flat) : NOTHING);
    const ways = [
        { key: "class", needs: "semantics", of: byClass, dulls: true },
        { key: "height", needs: "semantics", of: byHeight, dulls: true },
        { key: "track", needs: "instances", of: (flat) => trackColor(keyframe.instances[flat]), dulls: true },
        { key: "hits", needs: "hits", of: byCount("hits"), most: scene.most.hits },
        { key: "crossings", needs: "crossings", of: byCount("crossings"), most: scene.most.crossings },
        ...scene.cameras.map((name, bit) =>
            ({ key: `camera${bit}`, name: `what ${name} sees`, needs: "camera_bits", of: byCamera(bit) })),
    ];
    return ways.filter(({ needs }) => keyframe.has(needs)).map((way) => ({ name: `by ${way.key}`, ...way }));
}

/**
 * Colours of occupied voxels: what no camera sees is dull, unless the view says otherwise, or the colour
 * is to be read off a bar.
 */
export function cubeColor(keyframe, view, way) {
    if (view.cameras !== "dull" || !keyframe.hasCameras() || !way.dulls) return way.of;
    return (flat) => (keyframe.isHidden(flat) ? mix(way.of(flat), HIDDEN, 0.58) : way.of(flat));
}

/** Colour and opacity (0 to 255) in a slice, where what is free or unobserved shows as well. */
export function sliceColor(keyframe, way) {
    const free = way.key === "crossings" ? way.of : freeIn(keyframe, way);
    return (flat) => {
        if (keyframe.isOccupied(flat)) return [...way.of(flat), 255];
        if (!keyframe.isObserved(flat)) return [...UNOBSERVED, 205];
        return [...free(flat), 225];
    };
}

/** Colour and opacity (0 to 255) of free voxels as points. */
export function freeColor(keyframe, way) {
    const free = way.key === "crossings" ? way.of : freeIn(keyframe, way);
    return (flat) => [...free(flat), 150];
}

/** Colour and opacity of unobserved voxels as points. */
export function unobservedColor() {
    return UNOBSERVED_POINT;
}

/** Free voxels that a camera sees are lighter, where it is that camera's that are shown. */
function freeIn(keyframe, { key }) {
    if (!key.startsWith("camera")) return () => FREE;
    const bit = Number(key.slice("camera".length));
    return (flat) => ((keyframe.camera_bits[flat] >> bit) & 1 ? SEEN_FREE : FREE);
}
