// A plain subset of xacro: properties, macros with defaults and blocks, arguments, conditions, includes within the zip,
// arithmetic. Throws a sentence for what it does not know.
import { find } from "./meshes.js";

// ---- expressions: numbers, names, strings, + - * / // % **, comparisons, and or not, calls of a few functions ----

const functions = { sin: Math.sin, cos: Math.cos, tan: Math.tan, asin: Math.asin, acos: Math.acos, atan: Math.atan, atan2: Math.atan2,
  sqrt: Math.sqrt, abs: Math.abs, min: Math.min, max: Math.max, floor: Math.floor, ceil: Math.ceil, pow: Math.pow,
  radians: (x) => (x * Math.PI) / 180, degrees: (x) => (x * 180) / Math.PI, float: Number, int: Math.trunc, str: String };
const constants = { pi: Math.PI, e: Math.E, inf: Infinity, True: true, False: false, None: "" };
const levels = [["or"], ["and"], ["==", "!=", "<=", ">=", "<", ">"], ["+", "-"], ["*", "//", "/", "%"]];
const operations = { or: (a, b) => a || b, and: (a, b) => a && b, "==": (a, b) => a === b, "!=": (a, b) => a !== b,
  "<=": (a, b) => a <= b, ">=": (a, b) => a >= b, "<": (a, b) => a < b, ">": (a, b) => a > b, "+": (a, b) => a + b,
  "-": (a, b) => a - b, "*": (a, b) => a * b, "/": (a, b) => a / b, "//": (a, b) => Math.floor(a / b), "%": (a, b) => a - b * Math.floor(a / b) };

export function evaluate(text, lookup) {
  const tokens = text.match(/\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?|[A-Za-z_][\w.]*|'[^']*'|"[^"]*"|\*\*|\/\/|[=!<>]=|\S/g) ?? [];
  let at = 0;
  const fail = () => { throw new Error(`xacro: \${${text}} is beyond what this page evaluates`); };
  const expect = (token) => { if (tokens[at++] !== token) fail(); };
  function level(n) {
    if (n === levels.length) return unary();
    let value = level(n + 1);
    while (levels[n].includes(tokens[at])) value = operations[tokens[at++]](value, level(n + 1));
    return value;
  }
  function unary() {
    if (tokens[at] === "-") return at++, -unary();
    if (tokens[at] === "+") return at++, unary();
    if (tokens[at] === "not") return at++, !level(2);
    const value = atom();
    return tokens[at] === "**" ? (at++, value ** unary()) : value;
  }
  function atom() {
    const token = tokens[at++];
    if (token === undefined) fail();
    if (token === "(") { const value = level(0); expect(")"); return value; }
    if (/^[\d.]/.test(token)) return Number(token);
    if (/^['"]/.test(token)) return token.slice(1, -1);
    if (!/^[A-Za-z_]/.test(token)) fail();
    const name = token.replace(/^(math|xacro)\./, "");
    if (tokens[at] === "(" && Object.hasOwn(functions, name)) {
      const values = [];
      at++;
      while (tokens[at] !== ")") {
        values.push(level(0));
        if (tokens[at] !== ",") break;
        at++;
      }
      expect(")");
      return functions[name](...values);
    }
    const value = lookup(name);
    if (value !== undefined) return value;
    if (Object.hasOwn(constants, name)) return constants[name];
    throw new Error(`xacro: nothing is called ${name} in \${${text}}`);
  }
  const value = level(0);
  if (at < tokens.length) fail();
  return value;
}

// ---- expansion ----

const typed = (s) => (s.trim() !== "" && Number.isFinite(Number(s)) ? Number(s) : s === "true" || s === "True" ? true : s === "false" || s === "False" ? false : s);

class Expander {
  constructor(files) { this.files = files; this.macros = new Map(); this.arguments = new Map(); this.depth = 0; this.count = 0; }

  parse(text, name) {
    const document = new DOMParser().parseFromString(text, "text/xml"), error = document.querySelector("parsererror");
    if (error) throw new Error(`xacro: ${name} is not well-formed XML: ${error.textContent.replace(/\s+/g, " ").slice(0, 200)}`);
    return document;
  }

  // $(arg x), $(find x), and ${...}; a lone ${...} keeps its type.
  value(text, scope) {
    const lookup = (name) => {
      for (let s = scope; s; s = s.outer) if (s.names.has(name)) return s.names.get(name);
      return undefined;
    };
    const plain = text.replace(/\$\((\w+)\s+([^)]*)\)/g, (all, kind, name) => {
      if (kind === "find") return `package://${name}`;
      if (kind !== "arg" || !this.arguments.has(name)) throw new Error(`xacro: $(${kind} ${name}) is not known here`);
      return this.arguments.get(name);
    });
    const lone = plain.match(/^\$\{([^}]*)\}$/);
    if (lone) return evaluate(lone[1], lookup);
    return plain.replace(/\$\{([^}]*)\}/g, (all, inner) => String(evaluate(inner, lookup)));
  }

  expandChildren(node, into, scope) {
    for (const child of [...node.childNodes]) this.expand(child, into, scope);
  }

  expand(node, into, scope) {
    if (node.nodeType === Node.TEXT_NODE) into.append(into.ownerDocument.createTextNode(String(this.value(node.data, scope))));
    if (node.nodeType !== Node.ELEMENT_NODE) return;
    if (++this.count > 2e5 || this.depth > 100) throw new Error("xacro: this does not come to an end");
    if (!node.nodeName.startsWith("xacro:")) return this.copy(node, into, scope);
    const name = node.nodeName.slice(6), given = (a) => String(this.value(node.getAttribute(a) ?? "", scope));
    this.depth++;
    if (name === "property") this.property(node, scope);
    else if (name === "arg") { if (!this.arguments.has(given("name"))) this.arguments.set(given("name"), given("default")); }
    else if (name === "include") this.include(given("filename"), into, scope);
    else if (name === "macro") this.macros.set(node.getAttribute("name").replace(/^xacro:/, ""), node);
    else if (name === "if" || name === "unless") {
      if (Boolean(typed(given("value"))) === (name === "if")) this.expandChildren(node, into, scope);
    } else if (name === "insert_block") this.insert(given("name"), into, scope);
    else this.call(this.macros.get(name), node, name, into, scope);
    this.depth--;
  }

  copy(node, into, scope) {
    const element = into.ownerDocument.createElement(node.nodeName);
    for (const a of node.attributes) if (!a.name.startsWith("xmlns")) element.setAttribute(a.name, String(this.value(a.value, scope)));
    into.append(element);
    this.expandChildren(node, element, scope);
  }

  property(node, scope) {
    const value = node.hasAttribute("value") ? this.value(node.getAttribute("value"), scope) : { block: [...node.childNodes], scope };
    let place = scope;
    if (node.getAttribute("scope") === "parent") place = scope.outer ?? scope;
    if (node.getAttribute("scope") === "global") while (place.outer) place = place.outer;
    place.names.set(node.getAttribute("name"), typeof value === "string" ? typed(value) : value);
  }

  include(uri, into, scope) {
    const name = find(this.files, uri);
    if (!name) throw new Error(`xacro: ${uri} is not among the dropped files`);
    this.expandChildren(this.parse(new TextDecoder().decode(this.files[name]), name).documentElement, into, scope);
  }

  insert(name, into, scope) {
    for (let s = scope; s; s = s.outer) {
      const kept = s.names.get(name);
      if (kept?.block) return kept.block.forEach((n) => this.expand(n, into, kept.scope));
    }
    throw new Error(`xacro: there is no block ${name}`);
  }

  call(macro, node, name, into, scope) {
    if (!macro) throw new Error(`xacro: there is no macro ${name}`);
    const inner = { names: new Map(), outer: scope }, blocks = [...node.children];
    for (const p of macro.getAttribute("params")?.match(/[*]*\w+(?::?=(?:'[^']*'|"[^"]*"|\$\{[^}]*\}|\S+))?/g) ?? []) {
      const [, stars, parameter, fallback] = p.match(/^([*]*)(\w+)(?::?=(.*))?$/);
      if (stars) {
        const block = blocks.shift();
        if (!block) throw new Error(`xacro: macro ${name} needs a block ${parameter}`);
        inner.names.set(parameter, { block: stars === "**" ? [...block.childNodes] : [block], scope });
      } else if (node.hasAttribute(parameter)) {
        const value = this.value(node.getAttribute(parameter), scope);
        inner.names.set(parameter, typeof value === "string" ? typed(value) : value);
      } else if (fallback !== undefined) {
        const value = this.value(fallback.replace(/^\^\|?/, "").replace(/^(['"])(.*)\1$/, "$2"), scope);
        if (!fallback.startsWith("^") || value !== "") inner.names.set(parameter, typeof value === "string" ? typed(value) : value);
      } else throw new Error(`xacro: macro ${name} needs ${parameter}`);
    }
    this.expandChildren(macro, into, inner);
  }
}

// The URDF that a xacro says.
export function expandXacro(text, files, name) {
  const expander = new Expander(files), from = expander.parse(text, name).documentElement;
  const result = document.implementation.createDocument(null, from.nodeName);
  for (const a of from.attributes) if (!a.name.startsWith("xmlns")) result.documentElement.setAttribute(a.name, a.value);
  expander.expandChildren(from, result.documentElement, { names: new Map(), outer: null });
  return new XMLSerializer().serializeToString(result).replace(/\n(\s*\n)+/g, "\n");
}
