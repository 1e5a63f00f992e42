// What is found first by what people ask for: search_test.js SEARCH_INDEX.JS
"use strict";
const { find, excerpt, words } = require("./static/search.js"), assert = require("assert"), fs = require("fs");
const index = new Function(fs.readFileSync(process.argv[2], "utf8") + "return SEARCH_INDEX;")();

const first = [["rnea", "reference/rbd_dynamics.html", "c.rbd_rnea"], ["rbd_aba", "reference/rbd_dynamics.html", "c.rbd_aba"],
    ["inverse kinematics", "guides/inverse_kinematics.html", ""], ["nq", "reference/rbd_lookup.html", "c.rbd_nq"],
    ["RBD_ERR_SINGULAR", "reference/rbd_status.html", "c.rbd_status.RBD_ERR_SINGULAR"],
    ["gravity compensation", "guides/gravity_compensation.html", ""], ["glossary", "guides/glossary.html", ""],
    ["hinge loop", "reference/rbd_constraints.html", "c.rbd_hinge_loop"]];
for (const [query, page, anchor] of first) assert.deepStrictEqual(find(index, query)[0].slice(0, 2), [page, anchor], query);

for (const [query] of first) { // each answer has all words, and an excerpt that shows one where its text has one
    for (const [, , title, text] of find(index, query)) {
        const all = (title + " " + text).toLowerCase();
        assert.ok(words(query).every((w) => all.includes(w.replace(/^rbd_/, ""))), `${query}: ${title}`);
        if (words(query).some((w) => text.toLowerCase().includes(w))) assert.ok(words(query).some((w) => excerpt(text, words(query)).toLowerCase().includes(w)));
    }
}
assert.strictEqual(find(index, "xyzzy of nowhere").length, 0);
assert.strictEqual(find(index, "").length, 0);
console.log(`${index.length} places to find`);
