// Opens a page that `view` made in a browser without a network, and compares what it shows with the
// arrays it was made of. `node page.mjs PAGE EXPECTED`; the last line of stdout is what was measured.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

import { checkDecoded, checkFaces, checkRays } from "./page_parts.mjs";
import { openBrowser } from "./browser.mjs";

const [file, expectedFile] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(expectedFile, "utf8"));
const html = readFileSync(file, "utf8");

const measured = { decoded: await checkDecoded(html, expected), ...checkFaces(expected), ...checkRays(expected) };
const { browser, page, told } = await openBrowser();
try {
    await page.goto(pathToFileURL(file).href);
    await page.evaluate(() => globalThis.ready);
    measured.counts = await checkLegend();
    measured.picks = await checkPicks();
    measured.sliced = await checkSlice();
    measured.changed = await checkChanges();
    measured.drawn = await checkBudget();
    await checkAddress();
    await checkHostileNames();
    assert.deepEqual(told.requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
    assert.deepEqual(told.messages, []);
    measured.first_ms = await page.evaluate(() => globalThis.viewer.first_ms);
} finally {
    await browser.close();
}
console.log(JSON.stringify(measured));

/** The legend counts each class, free and unobserved as the arrays do. */
async function checkLegend() {
    const { semantics, mask_lidar } = expected.keyframes[0];
    const shown = await page.$$eval("#classes button", (buttons) =>
        buttons.map((button) => [Number(button.dataset.id), button.querySelector(".count").textContent]));
    assert.ok(shown.length > 3);
    const plain = (text) => Number(text.replaceAll("\u2009", ""));
    for (const [id, count] of shown) {
        assert.equal(plain(count), semantics.filter((other) => other === id).length, expected.classes[id]);
    }
    const states = await page.$$eval("#states .count", (counts) => counts.map((count) => count.textContent));
    const isFree = (flat) => semantics[flat] === expected.free;
    const free = semantics.filter((_, flat) => isFree(flat) && mask_lidar[flat]).length;
    const unobserved = semantics.filter((_, flat) => isFree(flat) && !mask_lidar[flat]).length;
    assert.deepEqual(states.map(plain), [free, unobserved]);
    return shown.length;
}

/** Clicks on the centres of the topmost voxels of columns, seen from above: most are what is picked. */
async function checkPicks() {
    await show({ cameras: "all", lines: false, flow: false }, "top");
    let [picks, asked, painted] = [0, 0, 0];
    const tracks = new Set();
    for (const voxel of topmost(expected.keyframes[0])) {
        const [x, y] = await page.evaluate((v) => globalThis.viewer.project(v), voxel);
        if (!(await isCanvas(x, y))) continue;
        await page.mouse.click(x, y);
        const facts = await factsShown();
        const flat = flatOf(facts.voxel.split(", ").map(Number));
        checkFacts(facts, expected.keyframes[0], flat);
        picks++;
        if (facts.track) tracks.add(facts.track);
        if (flat !== flatOf(voxel)) continue;
        asked++;
        painted += (await isPainted(x, y, expected.keyframes[0].semantics[flat])) ? 1 : 0;
    }
    assert.ok(picks >= 20 && asked > 0.8 * picks && painted > 0.9 * asked, `${picks} ${asked} ${painted}`);
    assert.ok(tracks.size >= 1);
    return { picks, asked, painted, tracks: tracks.size };
}

/** Some topmost occupied voxels of columns, and first those that belong to tracks. */
function topmost({ semantics, instances }) {
    const [nx, ny, nz] = expected.shape;
    const found = [];
    for (let x = 0; x < nx; x++) {
        for (let y = 0; y < ny; y++) {
            for (let z = nz - 1; z >= 0; z--) {
                if (semantics[flatOf([x, y, z])] === expected.free) continue;
                found.push([x, y, z]);
                break;
            }
        }
    }
    const rank = (voxel) => (instances[flatOf(voxel)] ? 0 : 1);
    const spread = found.filter((voxel, at) => rank(voxel) === 0 || at % 17 === 0);
    return spread.sort((a, b) => rank(a) - rank(b)).slice(0, 40);
}

async function factsShown() {
    await page.waitForSelector("#picked:not([hidden])");
    await page.evaluate(() => globalThis.viewer.settled);
    return page.evaluate(() => {
        const texts = (query) => [...document.querySelectorAll(query)].map((element) => element.textContent);
        const values = texts("#picked-facts dd");
        const rows = texts("#picked-facts dt").map((name, at) => [name, values[at]]);
        return { class: document.querySelector("#picked-class").textContent, ...Object.fromEntries(rows) };
    });
}

function checkFacts(facts, keyframe, flat) {
    const id = keyframe.semantics[flat];
    const isObserved = keyframe.mask_lidar[flat] !== 0;
    const isOccupied = id !== expected.free;
    const state = isOccupied ? "occupied" : isObserved ? "free" : "unobserved";
    assert.equal(facts.state, state);
    assert.equal(facts.class, isOccupied ? expected.classes[id] : state);
    assert.equal(facts.hits, String(keyframe.hits[flat]));
    assert.equal(facts.crossings, String(keyframe.crossings[flat]));
    const cameras = expected.cameras.filter((_, bit) => (keyframe.camera_bits[flat] >> bit) & 1);
    assert.equal(facts["seen by"], cameras.join(", ") || "no camera");
    const track = expected.tracks.find(([index]) => index === keyframe.instances[flat]);
    assert.equal(facts.track, track && String(track[0]));
    assert.equal(facts["track's id"], track?.[1]);
    assert.equal(facts.category, track?.[2]);
    assert.equal(facts.keyframe, keyframe.token);
    assert.equal(facts.configuration, expected.configuration);
    const metres = facts.centre.split(/[, ]+/).slice(0, 3).map(Number);
    const voxel = facts.voxel.split(", ").map(Number);
    metres.forEach((at, axis) => assert.ok(Math.abs(at - expected.min_m[axis] - (voxel[axis] + 0.5) * expected.size_m) < 0.006));
}

/** Whether no control lies over a place of the canvas. */
function isCanvas(x, y) {
    return page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.id === "canvas", [x, y]);
}

/** Whether the canvas has the colour of a class at a place, in some light. */
async function isPainted(x, y, id) {
    const [seen, color] = await page.evaluate(([x, y, id]) => {
        const { viewer } = globalThis;
        viewer.frame.visible = false;
        viewer.render();
        const [gl, pixel] = [viewer.renderer.getContext(), new Uint8Array(4)];
        const scale = viewer.canvas.width / viewer.canvas.clientWidth;
        gl.readPixels(x * scale, viewer.canvas.height - 1 - y * scale, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return [[...pixel.slice(0, 3)], viewer.scene.colors[viewer.view.colors][id]];
    }, [Math.floor(x), Math.floor(y), id]);
    const light = Math.max(...seen) / Math.max(...color);
    return light > 0.4 && light <= 1.01 && color.every((channel, i) => Math.abs(channel * light - seen[i]) < 4);
}

/** In a slice, what is free or unobserved can be picked too. */
async function checkSlice() {
    await show({ slice: { axis: 2, at: 2 } }, "top");
    const states = {};
    for (let x = 1; x < expected.shape[0]; x += 4) {
        for (let y = 2; y < expected.shape[1]; y += 5) {
            const [left, top] = await page.evaluate((v) => globalThis.viewer.project(v), [x, y, 2]);
            if (!(await isCanvas(left, top))) continue;
            await page.mouse.click(left, top);
            const facts = await factsShown();
            assert.equal(facts.voxel, [x, y, 2].join(", "));
            checkFacts(facts, expected.keyframes[0], flatOf([x, y, 2]));
            states[facts.state] = (states[facts.state] ?? 0) + 1;
        }
    }
    assert.ok(states.free > 3 && states.unobserved > 3, JSON.stringify(states));
    await show({ slice: { axis: null, at: 0 } }, "corner");
    await page.keyboard.press("Escape");
    return states;
}

/** Each control changes the picture, and what is taken back makes it what it was. */
async function checkChanges() {
    const changed = {};
    const differs = async (name, act, back) => {
        await keepPixels();
        await act();
        changed[name] = await differentPixels();
        assert.ok(changed[name] > 100, `${name}: ${changed[name]} pixels`);
        await back();
        assert.equal(await differentPixels(), 0, `${name} taken back`);
    };
    const key = (name) => async () => page.keyboard.press(name);
    const road = page.locator("#classes button", { hasText: "driveable surface" });
    await differs("keyframe", key("ArrowRight"), key("ArrowLeft"));
    await differs("slider", () => slide(2), () => slide(0));
    await differs("class", () => road.click(), () => road.click());
    await differs("crossings", () => page.selectOption("#by", "crossings"), () => page.selectOption("#by", "class"));
    await differs("hits", () => page.selectOption("#by", "hits"), () => page.selectOption("#by", "class"));
    await differs("camera", () => page.selectOption("#by", "camera0"), () => page.selectOption("#by", "class"));
    await differs("seen only", () => page.selectOption("#cameras", "only"), () => page.selectOption("#cameras", "all"));
    await differs("colours", () => page.selectOption("#colors", "color-blind"), () => page.selectOption("#colors", "standard"));
    await differs("lines", () => page.check("#lines"), () => page.uncheck("#lines"));
    await differs("arrows", () => page.check("#flow"), () => page.uncheck("#flow"));
    await differs("free points", () => page.check("#free"), () => page.uncheck("#free"));
    await differs("unobserved points", () => page.check("#unobserved"), () => page.uncheck("#unobserved"));
    return changed;
}

function slide(at) {
    return page.$eval("#at", (input, value) => {
        input.value = value;
        input.dispatchEvent(new Event("input"));
    }, at);
}

function keepPixels() {
    return page.evaluate(async () => {
        const { viewer } = globalThis;
        globalThis.pixels = async () => {
            await viewer.settled;
            viewer.render();
            const gl = viewer.renderer.getContext();
            const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
            const pixels = new Uint32Array(width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(pixels.buffer));
            return pixels;
        };
        globalThis.kept = await globalThis.pixels();
    });
}

function differentPixels() {
    return page.evaluate(async () => {
        const now = await globalThis.pixels();
        return now.reduce((count, pixel, at) => count + (pixel === globalThis.kept[at] ? 0 : 1), 0);
    });
}

/** With all that can be shown, triangles and draws stay below their limits. */
async function checkBudget() {
    await show({ flow: true, lines: true, free: true, unobserved: true, slice: { axis: 0, at: 3 } }, "corner");
    const { calls, triangles } = await page.evaluate(() => globalThis.viewer.renderer.info.render);
    assert.ok(calls > 6 && calls <= 50 && triangles > 1000 && triangles <= 300_000, `${calls} ${triangles}`);
    return { calls, triangles };
}

/** The address tells the view: opened again, the page shows the same. */
async function checkAddress() {
    await show({ at: 1, by: "hits", off: new Set([11]), slice: { axis: 2, at: 3 }, free: false, unobserved: false }, "behind");
    const address = await page.evaluate(() => globalThis.viewer.address());
    await keepPixels();
    const before = await page.evaluate(() => globalThis.kept.join());
    await page.goto("about:blank");
    await page.goto(pathToFileURL(file).href + address);
    await page.evaluate(() => globalThis.ready);
    await keepPixels();
    assert.equal(await page.evaluate(() => globalThis.kept.join()) === before, true, address);
}

/** Names that look like markup are text. */
async function checkHostileNames() {
    assert.ok(expected.tracks.some(([, id]) => id.includes("</script>")), "a hostile name");
    assert.equal(await page.evaluate(() => globalThis.hacked), undefined);
    assert.equal(await page.locator("img").count(), 0);
}

/** Shows a view from a place, and waits until it is drawn. */
async function show(changes, from) {
    const plain = { ...changes, off: changes.off && [...changes.off] };
    await page.evaluate(async ([changes, from]) => {
        const { viewer } = globalThis;
        if (changes.off) changes.off = new Set(changes.off);
        else delete changes.off;
        await viewer.set(changes);
        viewer.lookFrom(from);
        viewer.render();
    }, [plain, from]);
}

function flatOf([x, y, z]) {
    return (x * expected.shape[1] + y) * expected.shape[2] + z;
}
