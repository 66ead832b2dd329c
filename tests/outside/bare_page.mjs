// Opens a page of labels that hold classes only: nothing else is offered, nothing fails.

import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";

import { openBrowser } from "./browser.mjs";

const { browser, page, told } = await openBrowser({ width: 390, height: 844 });
try {
    // The address asks for what there is not.
    await page.goto(`${pathToFileURL(process.argv[2]).href}#k=99&by=hits&slice=7,7&cameras=only&eye=1,x`);
    await page.evaluate(() => globalThis.ready);
    const ways = await page.$$eval("#by option", (options) => options.map((option) => option.value));
    assert.deepEqual(ways, ["class", "height"]);
    for (const id of ["masks", "flow-row", "bar", "slice-row", "unobserved-row"]) {
        assert.equal(await page.$eval(`#${id}`, (element) => element.hidden), true, id);
    }
    await page.click("#panel-toggle");
    assert.ok(await page.isVisible("#classes"));
    await page.click("#panel-toggle");
    const drawn = await page.evaluate(() => globalThis.viewer.renderer.info.render.triangles);
    assert.ok(drawn > 500, `${drawn} triangles`);
    await page.evaluate(async () => {
        const { viewer } = globalThis;
        await viewer.pick(viewer.shown.indexOf(1));
    });
    const facts = await page.$$eval("#picked-facts dt", (names) => names.map((name) => name.textContent));
    assert.ok(facts.includes("voxel") && !facts.includes("hits") && !facts.includes("seen by"), facts.join());
    assert.deepEqual(told.messages, []);
} finally {
    await browser.close();
}
console.log("{}");
