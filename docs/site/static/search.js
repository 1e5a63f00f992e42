// Search without a server: search_index.js, which search_index.py writes, has the text of every page in
// [page, anchor, title, text, kind]; kind: 2 a declaration, 1 the head of a page, 0 a section.
"use strict";

const words = (text) => text.toLowerCase().match(/[\p{L}\p{N}_]+/gu) || [];
const bare = (name) => name.toLowerCase().replace(/^rbd_(urdf_)?/, "");

// How well an entry fits the words; 0 where one of them is missing.
function score([, anchor, title, text, kind], query) {
    const whole = query.join(" "), head = title.toLowerCase(), named = words(title), all = text.toLowerCase();
    let sum = 0;
    for (const word of query) {
        const inTitle = named.some((n) => n === word || bare(n) === bare(word)) ? 30 : named.some((n) => n.includes(word)) ? 12 : 0;
        const times = Math.min(4, all.split(word).length - 1);
        if (!inTitle && !times) return 0;
        sum += inTitle + times;
    }
    const member = /^c\.\w+\.[a-z]/.test(anchor); // of a struct
    if (head === whole || bare(head) === bare(whole)) sum += member ? 60 : kind === 2 ? 200 : 150;
    else if (head.startsWith(whole)) sum += 40;
    else if (all.includes(whole)) sum += 6;
    return sum + (sum > 30 ? 10 * kind : 0);
}

// Entries that fit, best first.
function find(index, text) {
    const query = words(text);
    if (!query.length) return [];
    return index.map((entry) => [score(entry, query), entry]).filter(([points]) => points > 0)
        .sort((a, b) => b[0] - a[0] || a[1][2].length - b[1][2].length).map(([, entry]) => entry);
}

// Some words around the first that was asked for.
function excerpt(text, query) {
    const all = text.toLowerCase(), places = query.map((word) => all.indexOf(word)).filter((at) => at >= 0);
    const from = places.length ? Math.max(0, Math.min(...places) - 70) : 0, start = from ? text.indexOf(" ", from) + 1 : 0;
    return (start ? "… " : "") + text.slice(start, start + 220) + (text.length > start + 220 ? " …" : "");
}

function show() {
    const text = new URLSearchParams(location.search).get("q") || "", place = document.getElementById("search-results");
    for (const input of document.querySelectorAll('input[name="q"]')) input.value = text;
    const found = find(SEARCH_INDEX, text), query = words(text), list = document.createElement("ul");
    const pages = new Map(SEARCH_INDEX.filter((e) => e[4] === 1).map((e) => [e[0], e[2]]));
    list.className = "search";
    for (const [page, anchor, title, body, kind] of found.slice(0, 40)) {
        const item = document.createElement("li"), link = document.createElement("a"), line = document.createElement("p");
        link.href = page + (anchor ? "#" + anchor : "");
        link.textContent = title;
        if (kind === 2) link.className = "name";
        const shown = kind === 2 ? body.replace(/^.*?\)\s(?=[A-Z])/, "").split(" argument shape meaning ")[0] : body; // sentences alone
        excerpt(shown, kind === 2 ? [] : query).split(new RegExp("(" + query.map((w) => w.replace(/\W/g, "")).join("|") + ")", "gi")).forEach((part, i) => {
            const piece = document.createElement(i % 2 ? "mark" : "span");
            piece.textContent = part;
            line.append(piece);
        });
        item.append(link, kind === 1 ? "" : ` · ${pages.get(page) || ""}`, line);
        list.append(item);
    }
    const title = document.createElement("h1"), head = document.createElement("p");
    title.textContent = "Search";
    head.textContent = !text ? "" : found.length ? `${found.length} places${found.length > 40 ? ", the best 40" : ""}` : "Nothing found. Try fewer words, or the name of a call.";
    place.replaceChildren(title, head, list);
}

if (typeof document === "undefined") module.exports = { find, excerpt, words };
else addEventListener("DOMContentLoaded", show);
