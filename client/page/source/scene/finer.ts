// Refines a surface: every edge gets a vertex in its middle, displaced along the normals of its ends, so that
// silhouettes of bodies with few vertices are round. Phong tessellation (Boubekeur and Alexa 2008), applied to the
// middles of edges only.

const kRoundness = 0.75; // 0: flat faces; 1: full displacement

export interface Finer {
  edges: Uint16Array; // two vertices each; the middle of edge i is vertex vertexCount + i
  faces: Uint16Array; // four per original face
}

// null when 16 bits cannot number the vertices.
export function MakeFiner(vertexCount: number, faces: Uint16Array): Finer | null {
  const middles = new Map<number, number>();
  const edges: number[] = [];
  const finer = new Uint16Array(4 * faces.length);
  const findMiddle = (a: number, b: number) => {
    const key = a < b ? a * 65536 + b : b * 65536 + a;
    let middle = middles.get(key);
    if (middle === undefined) {
      middle = vertexCount + edges.length / 2;
      middles.set(key, middle);
      edges.push(a, b);
    }
    return middle;
  };
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [faces[i], faces[i + 1], faces[i + 2]];
    const [ab, bc, ca] = [findMiddle(a, b), findMiddle(b, c), findMiddle(c, a)];
    finer.set([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], 4 * i);
  }
  return vertexCount + edges.length / 2 > 65535 ? null : { edges: new Uint16Array(edges), faces: finer };
}

// Writes the middles behind the vertices in both arrays.
export function FillMiddles(
  edges: Uint16Array,
  vertexCount: number,
  positions: Float32Array,
  normals: Float32Array,
): void {
  let to = 3 * vertexCount;
  for (let i = 0; i < edges.length; i += 2, to += 3) {
    const a = 3 * edges[i];
    const b = 3 * edges[i + 1];
    const x = positions[b] - positions[a];
    const y = positions[b + 1] - positions[a + 1];
    const z = positions[b + 2] - positions[a + 2];
    // Half of the edge, projected on the tangent planes of its ends.
    const overA = 0.25 * kRoundness * (x * normals[a] + y * normals[a + 1] + z * normals[a + 2]);
    const overB = -0.25 * kRoundness * (x * normals[b] + y * normals[b + 1] + z * normals[b + 2]);
    const nx = normals[a] + normals[b];
    const ny = normals[a + 1] + normals[b + 1];
    const nz = normals[a + 2] + normals[b + 2];
    const length = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
    positions[to] = 0.5 * (positions[a] + positions[b]) - overA * normals[a] - overB * normals[b];
    positions[to + 1] = 0.5 * (positions[a + 1] + positions[b + 1]) - overA * normals[a + 1] - overB * normals[b + 1];
    positions[to + 2] = 0.5 * (positions[a + 2] + positions[b + 2]) - overA * normals[a + 2] - overB * normals[b + 2];
    normals[to] = nx / length;
    normals[to + 1] = ny / length;
    normals[to + 2] = nz / length;
  }
}

// Middles of the rest shape without displacement: patterns only need values in between.
export function ExtendRest(rest: Float32Array, edges: Uint16Array): Float32Array {
  const extended = new Float32Array(rest.length + (3 * edges.length) / 2);
  extended.set(rest);
  let to = rest.length;
  for (let i = 0; i < edges.length; i += 2, to += 3) {
    for (let j = 0; j < 3; ++j) extended[to + j] = 0.5 * (rest[3 * edges[i] + j] + rest[3 * edges[i + 1] + j]);
  }
  return extended;
}
