// Keyframe after keyframe, as fast as they were recorded.

/** Where the labels do not tell the time: keyframes a second. */
const PLAYED_HZ = 2;
const [SHORTEST_S, LONGEST_S] = [0.05, 2];

/** Steps on, and from the last keyframe to the first, as long as the viewer is playing and is not played anew. */
export async function play(viewer) {
    const run = (viewer.run = {});
    while (viewer.isPlaying && viewer.run === run) {
        const last = viewer.keyframes.length - 1;
        const due_ms = performance.now() + 1000 * secondsToNext(viewer);
        await viewer.step(viewer.view.at === last ? -last : 1);
        await new Promise((done) => setTimeout(done, Math.max(due_ms - performance.now(), 15)));
    }
}

function secondsToNext({ scene, view }) {
    const [now, next] = [0, 1].map((by) => scene.keyframes[view.at + by]?.time_ns ?? null);
    if (now === null || next === null) return 1 / PLAYED_HZ;
    return Math.min(Math.max(Number(BigInt(next) - BigInt(now)) / 1e9, SHORTEST_S), LONGEST_S);
}
