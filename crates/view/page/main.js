// The viewer: it holds what is to be shown, and shows it.

import { Arrows } from "./arrows.js";
import { cubeColor, freeColor, PAPER, sliceColor, unobservedColor, waysToColor } from "./colors.js";
import { Controls, presetsOf } from "./controls.js";
import { Cubes } from "./cubes.js";
import { keepNearest } from "./faces.js";
import { factsOf } from "./facts.js";
import { hashOf, viewOf } from "./hash.js";
import { Keyframes } from "./keyframes.js";
import { press } from "./keys.js";
import { Labels } from "./labels.js";
import { Panel } from "./panel.js";
import { firstOnRay } from "./pick.js";
import { play } from "./play.js";
import { VoxelPoints } from "./points.js";
import { Slice } from "./slice.js";
import { frameOfPick, Surroundings } from "./surroundings.js";
import { centreOf, shownVoxels, tally, voxelAt } from "./voxels.js";

/** A click is a press that moved by fewer pixels. */
const CLICK_PX = 5;
const FOV_DEG = 40;
/** Faces beyond these are left out, those farthest from the ego first. */
const MOST_FACES = 2e6;

class Viewer {
    constructor(scene, textOf) {
        const occurs = [...new Set(scene.keyframes.flatMap(({ classes }) => classes))].sort((a, b) => a - b);
        this.scene = { ...scene, most: mostOf(scene), occurs };
        this.keyframes = new Keyframes(this.scene, textOf);
        this.canvas = document.getElementById("canvas");
        this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true });
        this.renderer.setClearColor(new THREE.Color().setRGB(...PAPER.map((c) => c / 255), THREE.SRGBColorSpace));
        this.camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.3, 2000);
        this.camera.up.set(0, 0, 1);
        this.world = new THREE.Scene();
        [this.cubes, this.slice, this.arrows] = [new Cubes(), new Slice(), new Arrows()];
        [this.free, this.unobserved] = [new VoxelPoints(), new VoxelPoints()];
        [this.surroundings, this.frame] = [new Surroundings(), frameOfPick()];
        this.world.add(this.surroundings, this.cubes, this.slice, this.arrows, this.frame);
        this.world.add(this.free, this.unobserved);
        this.controls = new Controls(this.camera, this.canvas, () => this.wake());
        this.labels = new Labels(document.getElementById("labels"));
        this.panel = new Panel(this);
        Object.assign(this, { turn: 0, picked: null, isPlaying: false, isAwake: false });
        this.listen();
    }

    /** Shows what the address says. */
    async start() {
        const { view, eye } = viewOf(location.hash, this.scene);
        this.view = view;
        this.resize();
        if (eye) this.controls.place(eye.slice(0, 3), eye.slice(3));
        else this.lookFrom("corner");
        await this.draw();
    }

    listen() {
        addEventListener("resize", () => this.resize());
        addEventListener("keydown", (event) => press(this, event));
        addEventListener("keyup", (event) => this.controls.key(event, false));
        addEventListener("blur", () => this.controls.release());
        addEventListener("hashchange", () => location.hash !== this.written && this.start());
        this.canvas.addEventListener("pointerdown", ({ offsetX, offsetY }) => (this.pressed = [offsetX, offsetY]));
        this.canvas.addEventListener("pointerup", (event) => this.release(event));
    }

    release({ offsetX, offsetY, button }) {
        const [x, y] = this.pressed ?? [NaN, NaN];
        if (button === 0 && Math.hypot(offsetX - x, offsetY - y) < CLICK_PX) this.pickAt(offsetX, offsetY);
    }

    /** Changes what is shown. */
    set(changes) {
        Object.assign(this.view, changes);
        return this.draw();
    }

    toggle(id) {
        const off = new Set(this.view.off);
        if (!off.delete(id)) off.add(id);
        return this.set({ off });
    }

    /** Goes on by so many keyframes, as far as there are. */
    step(by) {
        const at = Math.min(Math.max(this.view.at + by, 0), this.keyframes.length - 1);
        if (at === this.view.at) return Promise.resolve();
        this.picked = null;
        return this.set({ at });
    }

    lookFrom(name) {
        const [position, target] = presetsOf(this.keyframe ?? this.scene.keyframes[this.view.at])[name];
        this.controls.place(position, target);
        this.wake();
    }

    /** Decodes what is to be shown, and shows it; `settled` when that is done. */
    draw() {
        this.settled = this.drawNow();
        return this.settled;
    }

    /** Shows nothing if something else was asked for meanwhile. */
    async drawNow() {
        const turn = ++this.turn;
        const begun = performance.now();
        const keyframe = await this.keyframes.get(this.view.at);
        const ways = waysToColor(this.scene, keyframe, this.view);
        const way = ways.find(({ key }) => key === this.view.by) ?? ways[0];
        if (way.most) await keyframe.withCounts();
        if (turn !== this.turn) return;
        this.view.by = way.key;
        const decoded = performance.now();
        this.show(keyframe, way);
        this.panel.update({ keyframe, view: this.view, ways, counts: this.counts, scene: this.scene });
        const shown = performance.now();
        this.render();
        const drawn = performance.now();
        this.times_ms = { decode: decoded - begun, show: shown - decoded, draw: drawn - shown };
        this.first_ms ??= drawn;
        this.fetchAround();
        await this.pick(this.picked);
    }

    show(keyframe, way) {
        if (this.keyframe !== keyframe) this.counts = tally(keyframe);
        this.keyframe = keyframe;
        this.shown = shownVoxels(keyframe, this.view);
        const reach = this.keepNearest(keyframe);
        this.cubes.show(keyframe, this.shown, cubeColor(keyframe, this.view, way));
        this.slice.show(keyframe, this.view.slice, sliceColor(keyframe, way));
        this.panel.leftOut([reach, this.showPoints(keyframe, way)].join(" ").trim());
        this.arrows.show(keyframe, this.shown);
        this.arrows.visible = this.view.flow;
        this.surroundings.show(keyframe);
        this.surroundings.visible = this.view.lines;
    }

    /** Leaves out what is too much to be drawn; says what. */
    keepNearest({ shape, min_m, size_m }) {
        const ego = [0, 1].map((axis) => Math.floor(-min_m[axis] / size_m[axis]));
        const reach = keepNearest(this.shown, shape, ego, MOST_FACES);
        return reach === null ? "" : `Cubes farther than ${(reach * size_m[0]).toFixed(1)} m ahead, behind or aside are left out.`;
    }

    showPoints(keyframe, way) {
        const { slice, free, unobserved } = this.view;
        [this.free.visible, this.unobserved.visible] = [free, unobserved];
        const isFree = (flat) => keyframe.isObserved(flat) && !keyframe.isOccupied(flat);
        const isUnknown = (flat) => !keyframe.isObserved(flat) && !keyframe.isOccupied(flat);
        const every = Math.max(
            free ? this.free.show(keyframe, slice, isFree, freeColor(keyframe, way)) : 1,
            unobserved ? this.unobserved.show(keyframe, slice, isUnknown, unobservedColor) : 1,
        );
        return every > 1 ? `Of the points, one in ${every} is shown.` : "";
    }

    /** What will probably be asked for next. */
    fetchAround() {
        for (const at of [this.view.at + 1, this.view.at - 1]) {
            if (at >= 0 && at < this.keyframes.length) this.keyframes.get(at);
        }
    }

    render() {
        this.cubes.faceEye(this.camera.position);
        for (const points of [this.free, this.unobserved]) {
            points.material.uniforms.pixels.value = this.camera.projectionMatrix.elements[5] * this.canvas.height / 2;
        }
        this.renderer.render(this.world, this.camera);
        this.labels.place(this.camera, this.keyframe, this.view.lines, this.canvas);
        const distance_m = this.camera.position.distanceTo(this.controls.target);
        const height_m = 2 * distance_m * Math.tan((this.camera.fov * Math.PI) / 360);
        this.panel.showScale(this.camera.view.fullHeight / height_m);
        this.writeHash();
    }

    writeHash() {
        clearTimeout(this.writing);
        this.writing = setTimeout(() => {
            this.written = this.address();
            history.replaceState(null, "", this.written);
        }, 250);
    }

    /** The fragment that shows this again. */
    address() {
        return hashOf(this.view, this.controls);
    }

    /** Draws at the next frame, and goes on as long as something moves. */
    wake() {
        if (this.isAwake || !this.keyframe) return;
        this.isAwake = true;
        let before;
        const frame = (now) => {
            if (this.controls.isMoving) this.controls.advance(Math.min((now - (before ?? now)) / 1000, 0.1));
            before = now;
            this.render();
            this.isAwake = this.controls.isMoving;
            if (this.isAwake) requestAnimationFrame(frame);
        };
        requestAnimationFrame(frame);
    }

    resize() {
        const [width, height] = [innerWidth, innerHeight];
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.renderer.setSize(width, height, false);
        const { left, bottom } = this.panel.room(width, height);
        this.camera.aspect = left / bottom;
        // As much is seen across a narrow window as across a wide one.
        const half = Math.tan((FOV_DEG * Math.PI) / 360) / Math.min(this.camera.aspect / 1.3, 1);
        this.camera.fov = (2 * Math.atan(half) * 180) / Math.PI;
        this.camera.setViewOffset(left, bottom, 0, 0, width, height);
        this.wake();
    }

    /** Shows keyframe after keyframe, or stops. */
    play(isPlaying) {
        this.isPlaying = isPlaying;
        this.panel.showPlaying(isPlaying);
        play(this);
    }

    /** Picks the voxel under a place of the canvas, CSS pixels. */
    pickAt(x, y) {
        const { shape, min_m, size_m } = this.keyframe;
        const units = (p_m) => p_m.toArray().map((at, axis) => (at - min_m[axis]) / size_m[axis]);
        const near = new THREE.Vector3((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight, -1);
        const eye = units(this.camera.position);
        const way = units(near.unproject(this.camera)).map((at, axis) => at - eye[axis]);
        const found = firstOnRay(shape, eye, way, (flat) => this.isPickable(flat));
        return this.pick(found && found.flat);
    }

    /** Shown cubes, and all of the slice. */
    isPickable(flat) {
        const { axis, at } = this.view.slice;
        return this.shown[flat] === 1 || (axis !== null && voxelAt(this.keyframe.shape, flat)[axis] === at);
    }

    /** Shows the facts of a voxel, or none; `settled` when that is done. */
    pick(flat) {
        this.settled = this.pickNow(flat);
        return this.settled;
    }

    async pickNow(flat) {
        this.picked = flat;
        this.frame.visible = flat !== null;
        if (flat === null) {
            this.panel.showPicked(null);
        } else {
            const keyframe = await this.keyframe.withCounts();
            if (this.picked !== flat || this.keyframe !== keyframe) return;
            this.frame.position.fromArray(centreOf(keyframe, voxelAt(keyframe.shape, flat)));
            this.frame.scale.fromArray(keyframe.size_m);
            this.panel.showPicked(factsOf(this.scene, keyframe, flat, this.scene.colors[this.view.colors]));
        }
        this.wake();
    }

    /** Where the centre of a voxel is on the canvas, CSS pixels. */
    project(voxel) {
        const p = new THREE.Vector3(...centreOf(this.keyframe, voxel)).project(this.camera);
        return [((p.x + 1) / 2) * this.canvas.clientWidth, ((1 - p.y) / 2) * this.canvas.clientHeight];
    }
}

/** The largest counts of all keyframes. */
function mostOf({ keyframes }) {
    const most = (name) => Math.max(0, ...keyframes.map((keyframe) => keyframe.most[name] ?? 0));
    return { hits: most("hits"), crossings: most("crossings") };
}

const text = (id) => document.getElementById(id).textContent;
try {
    globalThis.viewer = new Viewer(JSON.parse(text("scene")), text);
    globalThis.ready = globalThis.viewer.start();
} catch (error) {
    document.getElementById("message").hidden = false;
    document.getElementById("message").textContent = `This page needs WebGL 2. (${error.message})`;
    throw error;
}
