// Chromium without a screen, a graphics card or a network.

import { chromium } from "playwright-core";

const FLAGS = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--no-first-run",
];

/** A page, and what it asks of the network and tells on its console. */
export async function openBrowser(viewport = { width: 1280, height: 720 }) {
    const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: FLAGS });
    const context = await browser.newContext({ viewport, offline: true });
    const page = await context.newPage();
    const told = { requests: [], messages: [] };
    page.on("request", (request) => told.requests.push(request.url()));
    page.on("console", (message) => told.messages.push(message.text()));
    page.on("pageerror", (error) => told.messages.push(String(error)));
    return { browser, page, told };
}
