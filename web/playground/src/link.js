// The part of the address behind #: the robot, or its text, and its pose. A browser sends it to no server.
const most = 24000; // characters of a text, packed, that still make a link

async function packed(text, way) {
  const stream = new Blob([text]).stream().pipeThrough(way);
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function writeLink(robot) {
  const { source } = robot, parts = new URLSearchParams();
  if (source.id) parts.set("robot", source.id);
  else {
    const bytes = await packed(source.text, new CompressionStream("deflate-raw"));
    const text = btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(""));
    if (text.length < most) parts.set("urdf", text), parts.set("name", source.name);
    if (source.floating) parts.set("floating", "1");
    if (source.massless) parts.set("massless", "1");
  }
  parts.set("q", [...robot.q()].map((x) => Number(x.toFixed(4))).join(" "));
  return `#${parts}`;
}

// { id } or { source }, and q; null without a robot.
export async function readLink(hash) {
  const parts = new URLSearchParams(hash.slice(1)), q = parts.get("q")?.split(" ").map(Number);
  const pose = q?.every(Number.isFinite) ? q : null;
  if (parts.has("robot")) return { id: parts.get("robot"), q: pose };
  if (!parts.has("urdf")) return null;
  try {
    const bytes = Uint8Array.from(atob(parts.get("urdf")), (c) => c.charCodeAt(0));
    const text = new TextDecoder().decode(await packed(bytes, new DecompressionStream("deflate-raw")));
    return { source: { name: parts.get("name") ?? "robot.urdf", text, floating: parts.has("floating"), massless: parts.has("massless") }, q: pose };
  } catch { return null; }
}
