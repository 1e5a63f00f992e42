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
const readers = {
  stl: (bytes, material) => new THREE.Mesh(new STLLoader().parse(bytes.slice().buffer), material),
  // In the link's axes as it stands, as RViz takes it: the loader would turn what has z upwards.
  dae: (bytes, material, manager) => new ColladaLoader(manager).parse(text(bytes).replace(/(<up_axis>)[^<]*/, "$1Y_UP"), "").scene,
  obj: (bytes, material, manager) => {
    const object = new OBJLoader(manager).parse(text(bytes));
    object.traverse((o) => { if (o.isMesh) o.material = material; });
    return object;
  },
};

// For urdf-loader; failures leave the place empty.
export function meshLoader(files, drawn) {
  return (uri, manager, material, done) => {
    const name = find(files, uri), reader = readers[name?.split(".").pop().toLowerCase()];
    try {
      if (reader) done(reader(files[name], material, manager));
    } catch { done(null); }
    drawn();
  };
}
