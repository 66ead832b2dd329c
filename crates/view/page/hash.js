// What is shown, in the address, so that it can be shared.

/** The fragment of an address for a view and a camera. */
export function hashOf(view, controls) {
    const metres = (vector) => vector.toArray().map((at) => Number(at.toFixed(2)));
    const parts = new URLSearchParams({ k: view.at, by: view.by });
    if (view.off.size > 0) parts.set("off", [...view.off].join());
    if (view.cameras !== "dull") parts.set("cameras", view.cameras);
    if (view.lidar !== "all") parts.set("lidar", view.lidar);
    for (const name of ["free", "unobserved"]) if (view[name]) parts.set(name, "1");
    if (!view.flow) parts.set("flow", "0");
    if (!view.lines) parts.set("lines", "0");
    if (view.slice.axis !== null) parts.set("slice", [view.slice.axis, view.slice.at].join());
    parts.set("colors", view.colors);
    parts.set("eye", [...metres(controls.camera.position), ...metres(controls.target)].join());
    return `#${parts.toString().replaceAll("%2C", ",")}`;
}

/** The view and, if it is told, the eye (place and target) of an address's fragment. */
export function viewOf(hash, scene) {
    const parts = new URLSearchParams(hash.slice(1));
    const numbers = (name) => (parts.get(name) ?? "").split(",").filter(Boolean).map(Number);
    const one = (name, values) => (values.includes(parts.get(name)) ? parts.get(name) : values[0]);
    const sets = [scene.chosen, ...Object.keys(scene.colors)];
    const view = {
        at: bounded(numbers("k")[0], scene.keyframes.length),
        by: parts.get("by") ?? "class",
        colors: one("colors", sets),
        cameras: one("cameras", ["dull", "all", "only"]),
        lidar: one("lidar", ["all", "only"]),
        off: new Set(numbers("off").filter((id) => id >= 0 && id < 255)),
        free: parts.get("free") === "1",
        unobserved: parts.get("unobserved") === "1",
        flow: parts.get("flow") !== "0",
        lines: parts.get("lines") !== "0",
        slice: sliceOf(numbers("slice"), scene),
    };
    const eye = numbers("eye");
    return { view, eye: eye.length === 6 && eye.every(Number.isFinite) ? eye : null };
}

function sliceOf([axis, at], scene) {
    const layers = scene.keyframes[0].shape[axis];
    return layers === undefined ? { axis: null, at: 0 } : { axis, at: bounded(at, layers) };
}

/** A whole number below a limit. */
function bounded(value, limit) {
    return Number.isInteger(value) ? Math.min(Math.max(value, 0), limit - 1) : 0;
}
