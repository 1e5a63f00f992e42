// The built site in a browser, from its files: browser.mjs SITE. No page logs an error, asks a server, cuts code at 1360
// pixels or is wider than a phone; long pages have contents; search lists; the playground is in the menu and leads back.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const site = resolve(process.argv[2]), here = dirname(fileURLToPath(import.meta.url));
const puppeteer = createRequire(join(here, "../../web/playground/package.json"))("puppeteer-core");
const chromium = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find((p) => p && existsSync(p));
const scratch = mkdtempSync(join(tmpdir(), "rbd-site-")), complaints = [];
const browser = await puppeteer.launch({ executablePath: chromium, headless: true, timeout: 600000, protocolTimeout: 7200000,
  userDataDir: join(scratch, "profile"), defaultViewport: { width: 1360, height: 900 },
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const page = await browser.newPage();
page.on("pageerror", (e) => complaints.push(`${page.url()}: ${e.message}`));
page.on("console", (m) => { if (["error", "warning", "warn"].includes(m.type()) && !/GPU stall|GL Driver/.test(m.text())) complaints.push(`${page.url()}: ${m.text()}`); });
page.on("request", (r) => { if (!/^(file|data|blob):/.test(r.url())) complaints.push(`${page.url()} asks for ${r.url()}`); });
const visit = (path) => page.goto(pathToFileURL(join(site, path.split("?")[0])).href + (path.includes("?") ? `?${path.split("?")[1]}` : ""));

try {
  const pages = ["guides", "reference", "."].flatMap((d) => readdirSync(join(site, d)).filter((f) => f.endsWith(".html")).map((f) => join(d, f)));
  for (const path of pages) {
    await visit(path);
    const seen = await page.evaluate(() => ({
      wide: document.documentElement.scrollWidth > innerWidth,
      cut: [...document.querySelectorAll("article pre")].filter((e) => e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent.slice(0, 60)),
      buttons: document.querySelectorAll("article div.highlight").length - document.querySelectorAll("button.copy").length,
      long: document.body.scrollHeight > 4000, contents: document.querySelectorAll(".toc-tree a, article table a.reference").length,
      foot: document.querySelector("footer")?.textContent ?? "",
    }));
    const say = (wrong, words) => { if (wrong) complaints.push(`${path}: ${words}`); };
    say(seen.wide, "wider than 1360 pixels");
    say(seen.cut.length, `cuts code: ${seen.cut}`);
    say(seen.buttons, "blocks without a button to copy");
    say(seen.long && seen.contents < 2 && !path.includes("bench_results"), "long, and has no contents");
    say(!/Copyright © \d{4}/.test(seen.foot), "no copyright");
  }
  for (const width of [400, 800]) {
    await page.setViewport({ width, height: 800 });
    for (const path of pages) {
      await visit(path);
      if ((await page.evaluate(() => document.documentElement.scrollWidth)) > width) complaints.push(`${path}: wider than ${width} pixels`);
    }
  }
  await page.setViewport({ width: 1360, height: 900 });
  await visit("search.html?q=rnea");
  await page.waitForSelector("ul.search li");
  assert.equal(await page.$eval("ul.search li a", (a) => a.textContent), "rbd_rnea");
  assert.match(await page.$eval("ul.search li p", (p) => p.textContent), /inverse|torque/i);
  await page.click("ul.search li a");
  await page.waitForFunction("location.hash === '#c.rbd_rnea'");
  if (existsSync(join(site, "playground/index.html"))) {
    await visit("index.html");
    await page.$eval('.sidebar-tree a[href="playground/index.html"]', (a) => a.click());
    await page.waitForFunction("window.playground?.ready", { timeout: 600000 });
    await page.click("h1 a");
    await page.waitForSelector(".landing");
    assert.equal(await page.$eval("a.look", (a) => a.getAttribute("href")), "playground/index.html");
  }
  assert.deepEqual(complaints, []);
  console.log(`${pages.length} pages looked at`);
} finally {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
}
