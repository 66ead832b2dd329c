// Words in the scene: where forward and left are, and distances along the grid's sides.

import { maxOf } from "./voxels.js";

const WORD_STEP_M = 20;

/** Words that stand at places of the grid frame, laid over the canvas. */
export class Labels {
    constructor(layer) {
        this.layer = layer;
    }

    place(camera, keyframe, isOn, canvas) {
        this.layer.hidden = !isOn;
        if (!isOn) return;
        const words = wordsOf(keyframe);
        while (this.layer.children.length < words.length) this.layer.append(document.createElement("span"));
        [...this.layer.children].forEach((span, at) => this.put(span, words[at], camera, canvas));
    }

    put(span, word, camera, canvas) {
        span.hidden = word === undefined;
        if (span.hidden) return;
        const p = new THREE.Vector3(...word.at).project(camera);
        span.hidden = Math.abs(p.z) > 1;
        span.textContent = word.text;
        span.style.left = `${(((p.x + 1) / 2) * canvas.clientWidth).toFixed(1)}px`;
        span.style.top = `${(((1 - p.y) / 2) * canvas.clientHeight).toFixed(1)}px`;
    }
}

/** Whether the ego's forward is so near to x that x may be called so. */
const isAhead = ({ heading_rad }) => heading_rad !== null && Math.abs(heading_rad) < 0.1;

/** Forward and left from the ego, and each 20 m at the near sides of the floor. */
function wordsOf(grid) {
    const [low, high] = [grid.min_m, maxOf(grid)];
    const words = [
        { text: isAhead(grid) ? "x forward" : "x", at: [high[0] + 2, 0, low[2]] },
        { text: isAhead(grid) ? "y left" : "y", at: [0, high[1] + 2, low[2]] },
    ];
    for (const axis of [0, 1]) {
        for (let metres = Math.ceil(low[axis] / WORD_STEP_M) * WORD_STEP_M; metres <= high[axis]; metres += WORD_STEP_M) {
            if (axis === 1 && metres - low[1] < 5) continue;
            const at = axis === 0 ? [metres, low[1] - 1.5, low[2]] : [low[0] - 1.5, metres, low[2]];
            words.push({ text: `${metres} m`, at });
        }
    }
    return words;
}
