// The page's controls: they tell the viewer what to show, and show what it shows.

import { logShare, ramp, UNNAMED } from "./colors.js";
import { presetsOf } from "./controls.js";

const CHOICES = ["by", "colors", "cameras", "lidar"];
const CHECKS = ["flow", "lines", "free", "unobserved"];

const $ = (id) => document.getElementById(id);
const css = (color) => `rgb(${color.join()})`;
const number = (n) => n.toLocaleString("en").replaceAll(",", "\u2009");

/** An element with a text and properties; text is never markup. */
function element(tag, text = "", properties = {}) {
    const made = Object.assign(document.createElement(tag), properties);
    made.textContent = text;
    return made;
}

function swatch(color, isOn = true) {
    const made = element("span", "", { className: "swatch" });
    made.style.background = isOn ? css(color) : "none";
    made.style.borderColor = css(color);
    return made;
}

/** Rows of a definition list. */
function fill(list, rows) {
    list.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
}

/** The controls around a viewer. */
export class Panel {
    constructor(viewer) {
        this.viewer = viewer;
        this.fillOnce(viewer.scene);
        this.listen();
        this.listenToTime();
    }

    fillOnce(scene) {
        document.title = `${scene.name || "labels"} · occlabel`;
        $("scene-name").textContent = scene.name || "labels";
        const sets = Object.keys(scene.colors).map((set) => element("option", `${set} colours`, { value: set }));
        $("colors").replaceChildren(...sets);
        const names = Object.keys(presetsOf(scene.keyframes[0]));
        const buttons = names.map((name) => element("button", name, { onclick: () => this.viewer.lookFrom(name) }));
        $("presets").replaceChildren(...buttons);
        $("at").max = scene.keyframes.length - 1;
        $("time").hidden = scene.keyframes.length < 2;
        fill($("about"), scene.about);
    }

    listen() {
        const { viewer } = this;
        for (const id of CHOICES) {
            $(id).onchange = () => viewer.set({ [id]: $(id).value });
        }
        for (const id of CHECKS) $(id).onchange = () => viewer.set({ [id]: $(id).checked });
        $("all").onclick = () => viewer.set({ off: new Set() });
        $("none").onclick = () => viewer.set({ off: new Set(viewer.scene.occurs) });
        $("fly").onchange = () => viewer.controls.fly($("fly").checked);
        for (const button of $("slice-axis").children) button.onclick = () => this.sliceAcross(button.dataset.axis);
        $("slice-at").oninput = () => viewer.set({ slice: { ...viewer.view.slice, at: $("slice-at").valueAsNumber } });
        $("picked-close").onclick = () => viewer.pick(null);
        $("panel-toggle").onclick = () => {
            const isOpen = $("panel").classList.toggle("open");
            $("panel-toggle").setAttribute("aria-expanded", isOpen);
        };
    }

    listenToTime() {
        const { viewer } = this;
        $("at").oninput = () => viewer.step($("at").valueAsNumber - viewer.view.at);
        $("before").onclick = () => viewer.step(-1);
        $("after").onclick = () => viewer.step(1);
        $("play").onclick = () => viewer.play(!viewer.isPlaying);
    }

    sliceAcross(text) {
        const axis = text === "" ? null : Number(text);
        const { shape, min_m, size_m } = this.viewer.keyframe;
        const start = axis === 2 ? Math.round((1 - min_m[2]) / size_m[2]) : Math.floor((shape[axis] ?? 0) / 2);
        const at = axis === null ? 0 : Math.min(Math.max(start, 0), shape[axis] - 1);
        this.viewer.set({ slice: { axis, at } });
    }

    /** Shows what the viewer shows. */
    update({ keyframe, view, ways, counts, scene }) {
        $("keyframe-name").textContent = keyframe.token;
        $("at").value = view.at;
        $("at-text").textContent = this.timeText(keyframe, view.at);
        $("by").replaceChildren(...ways.map(({ key, name }) => element("option", name, { value: key })));
        for (const id of CHOICES) $(id).value = view[id];
        for (const id of CHECKS) $(id).checked = view[id];
        $("cameras-row").hidden = !keyframe.hasCameras();
        $("lidar-row").hidden = !keyframe.has("mask_lidar");
        $("masks").hidden = $("cameras-row").hidden && $("lidar-row").hidden;
        $("flow-row").hidden = !keyframe.has("flow");
        this.updateBar(ways.find(({ key }) => key === view.by));
        this.updateClasses(scene, view, counts);
        this.updateSlice(keyframe, view.slice, counts);
    }

    timeText(keyframe, at) {
        const times = this.viewer.scene.keyframes.map(({ time_ns }) => time_ns);
        const place = `${at + 1} / ${times.length}`;
        if (keyframe.time_ns === null || times[0] === null) return place;
        const seconds = Number(BigInt(keyframe.time_ns) - BigInt(times[0])) / 1e9;
        return `${place} · ${seconds.toFixed(2)} s`;
    }

    updateBar({ most }) {
        $("bar").hidden = !most;
        if (!most) return;
        const steps = Array.from({ length: 17 }, (_, at) => css(ramp(at / 16)));
        $("bar-ramp").style.background = `linear-gradient(to right, ${steps.join()})`;
        const ticks = [1, 10, 100, 1000, 10000].filter((tick) => logShare(tick, most) < 0.88).concat(most);
        $("bar-ticks").replaceChildren(...ticks.map((tick) => {
            const label = element("span", number(tick));
            label.style.left = `${100 * logShare(tick, most)}%`;
            return label;
        }));
    }

    updateClasses(scene, view, counts) {
        const row = (id) => ({ id, name: scene.classes[id] ?? `class ${id}`, color: scene.colors[view.colors][id] ?? UNNAMED });
        $("classes").replaceChildren(...scene.occurs.map((id) => this.classRow(row(id), view, counts)));
    }

    classRow({ id, name, color }, view, counts) {
        const isOn = !view.off.has(id);
        const button = element("button", "", { onclick: () => this.viewer.toggle(id) });
        button.classList.toggle("off", !isOn);
        button.classList.toggle("none", counts.classes[id] === 0);
        button.setAttribute("aria-pressed", isOn);
        button.dataset.id = id;
        const count = element("span", number(counts.classes[id]), { className: "count" });
        button.append(swatch(color, isOn), element("span", name, { className: "name", title: name }), count);
        const row = element("li");
        row.append(button);
        return row;
    }

    updateSlice(keyframe, { axis, at }, counts) {
        const { shape, min_m, size_m } = keyframe;
        for (const button of $("slice-axis").children) {
            button.setAttribute("aria-pressed", button.dataset.axis === String(axis ?? ""));
        }
        $("slice-row").hidden = axis === null;
        if (axis !== null) {
            $("slice-at").max = shape[axis] - 1;
            $("slice-at").value = at;
            $("slice-m").textContent = `${"xyz"[axis]} ${(min_m[axis] + (at + 0.5) * size_m[axis]).toFixed(2)} m`;
        }
        $("free-name").textContent = keyframe.emptyName();
        $("unobserved-name").textContent = keyframe.has("mask_lidar") ? "unobserved" : "no label";
        $("unobserved-row").hidden = counts.unobserved === 0 && !keyframe.has("mask_lidar");
        for (const state of ["free", "unobserved"]) $(`${state}-count`).textContent = number(counts[state]);
    }

    /** Shows the facts of a voxel, or that none is picked. */
    showPicked(facts) {
        $("picked").hidden = facts === null;
        if (facts === null) return;
        $("picked-class").replaceChildren(swatch(facts.color), element("span", facts.class));
        fill($("picked-facts"), facts.rows);
    }

    showPlaying(isPlaying) {
        $("play").textContent = isPlaying ? "❚❚" : "▶";
        $("play").setAttribute("aria-label", isPlaying ? "Pause" : "Play");
    }

    /** A text in the middle, or none. */
    say(text) {
        $("message").hidden = !text;
        $("message").textContent = text;
    }

    /** How much of a window is not under the controls, from its upper left corner. */
    room(width, height) {
        const side = $("panel").getBoundingClientRect();
        const isBeside = side.width > 0 && width > 720;
        return { left: isBeside ? side.left : width, bottom: height - 60 };
    }

    leftOut(text) {
        $("left-out").hidden = !text;
        $("left-out").textContent = text;
    }

    /** A bar of a round length, for a number of pixels a metre. */
    showScale(pixels_per_m) {
        const lengths_m = [0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200];
        const length_m = lengths_m.findLast((metres) => metres * pixels_per_m <= 130) ?? lengths_m[0];
        $("scale-bar").style.width = `${(length_m * pixels_per_m).toFixed(1)}px`;
        $("scale-m").textContent = `${length_m} m at the centre`;
    }
}
