// What a browser without a network makes of a run's report: node report.mjs REPORT.html

import { openBrowser } from "./browser.mjs";

const { browser, page, told } = await openBrowser();
const url = `file://${process.argv[2]}`;
await page.goto(url);

/** How many colours each plot has; one that nothing was drawn on has one. */
const plots = () =>
    page.evaluate(() => {
        const colors = (canvas) => {
            const { width, height } = canvas;
            const pixels = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, width, height).data.buffer);
            return new Set(pixels).size;
        };
        return Object.fromEntries([...document.querySelectorAll("canvas")].map((c) => [c.id, colors(c)]));
    });

/** What is drawn on a plot. */
const picture = (id) => page.evaluate((id) => document.getElementById(id).toDataURL(), id);

const before = await picture("plot-occupied");
const scenes = await page.locator("#scene option").allTextContents();
await page.selectOption("#scene", { index: scenes.length - 1 });
const after = await picture("plot-occupied");
const pictures = page.locator("img");

console.log(
    JSON.stringify({
        messages: told.messages,
        requests: told.requests.filter((request) => request !== url && !request.startsWith("data:")),
        plots: await plots(),
        scenes,
        scene_changes_plot: before !== after,
        hacked: await page.evaluate(() => "hacked" in window),
        pictures: await pictures.count(),
        loaded: await pictures.evaluateAll((all) => all.filter((img) => img.naturalWidth > 0).length),
        strange: await page.locator("iframe, object, embed, link, img:not([src^='data:image/png'])").count(),
        first: await page.locator("#first .cards li").first().innerText({ timeout: 1000 }).catch(() => ""),
        wide: await page.evaluate(() => document.documentElement.scrollWidth > window.innerWidth),
    }),
);
await browser.close();
