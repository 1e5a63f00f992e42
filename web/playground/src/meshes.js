// Meshes and textures of a dropped zip. Nothing is ever asked of a server: what is not in the zip is not drawn.
import * as THREE from "three";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { ColladaLoader } from "three/examples/jsm/loaders/ColladaLoader.js";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";

const nothing = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";

// The file of the zip that a URI means: package://name/path, file://path or a relative one. The longest common end wins.
export function find(files, uri) {
  const wanted = decodeURI(uri).replace(/^[a-z]+:\/\//, "").split(/[\\/]/).filter((s) => s && s !== "." && s !== "..");
  let best = null, length = 0;
  for (const name of Object.keys(files)) {
    const parts = name.split("/");
    let n = 0;
    while (n < Math.min(parts.length, wanted.length) && parts.at(-1 - n) === wanted.at(-1 - n)) n++;
    if (n > length) [best, length] = [name, n];
  }
  return best;
}

export function textureManager(files) {
  const manager = new THREE.LoadingManager();
  manager.setURLModifier((uri) => {
    if (/^(data|blob):/.test(uri)) return uri;
    const name = find(files, uri);
    return name ? URL.createObjectURL(new Blob([files[name]])) : nothing;
  });
  return manager;
}

const text = (bytes) => new TextDecoder().decode(bytes);

// A surface without normals, or with zeros for them, as some programs write STL, would be drawn black.
function withNormals(object) {
  object.traverse((o) => {
    const normal = o.isMesh && o.geometry.attributes.normal;
    if (o.isMesh && (!normal || normal.array.every((x) => x === 0))) o.geometry.computeVertexNormals();
  });
  return object;
}

const readers = {
  stl: (bytes, material) => {
    const geometry = new STLLoader().parse(bytes.slice().buffer);
    geometry.computeVertexNormals(); // of the triangles: what the file says of them may be zeros
    return new THREE.Mesh(geometry, material);
  },
  // In the link's axes as it stands, as RViz takes it: the loader would turn what has z upwards.
  dae: (bytes, material, manager) => new ColladaLoader(manager).parse(text(bytes).replace(/(<up_axis>)[^<]*/, "$1Y_UP"), "").scene,
  obj: (bytes, material, manager) => {
    const object = new OBJLoader(manager).parse(text(bytes));
    object.traverse((o) => { if (o.isMesh) o.material = material; });
    return object;
  },
};

// For urdf-loader; missing(uri, why) is told of each mesh that leaves its place empty.
export function meshLoader(files, drawn, missing) {
  return (uri, manager, material, done) => {
    const name = find(files, uri), reader = readers[(name ?? uri).split(".").pop().toLowerCase()];
    try {
      if (name && reader) done(withNormals(reader(files[name], material, manager)));
      else missing(uri, reader ? "it is not there" : "only STL, Collada and Wavefront are read");
    } catch {
      missing(uri, "it is broken");
    }
    drawn();
  };
}
