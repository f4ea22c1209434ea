// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the parts of a head.glb that are shown (docs/formats.md). Attributes are views into the
// file's bytes: nothing is copied that need not be.

export type Vec3 = [number, number, number];

export interface Surface {
  /** xyz per vertex, mm, head frame */
  positions: Float32Array;
  /** unit, head frame */
  normals: Float32Array;
  triangles: Uint32Array;
  count: number;
}

export interface Landmark {
  name: string;
  /** mm, head frame */
  position: Vec3;
  confidence: number;
}

/** x_head = rotation (x_scan in mm - origin) */
interface Frame {
  rotation: number[][];
  origin_mm: number[];
}

export interface Head {
  skin: Surface;
  skull: Surface | null;
  /** N, ascending */
  forces: number[];
  /** per force: mm of travel per vertex, -1 where there is none */
  travel: Float32Array[];
  /** mm from skin to bone, -1 where none */
  depth: Float32Array;
  /** relative error of the travel, -1 where none */
  error: Float32Array;
  /** how the skin around a press goes down, where the file tells; radii in mm from the axis */
  dents: { radii: number[]; share: Float32Array[] } | null;
  /** 1 where the press moves skin that was completed from another head, else 0; null where none was */
  completed: Float32Array | null;
  region: Float32Array;
  status: Float32Array;
  regionNames: string[];
  statusNames: string[];
  toolRadius: number;
  input: string;
  landmarks: Landmark[];
  frame: Frame;
}

/** What `palpate fit` says of a head with other landmarks. */
export interface Fit {
  skull: Surface;
  /** as in Head */
  depth: Float32Array;
  region: Float32Array;
  /** of the head that it belongs to */
  fileDepth: Float32Array;
}

interface Accessor {
  bufferView: number;
  byteOffset?: number;
  count: number;
  type: string;
  componentType: number;
}
interface Document {
  accessors: Accessor[];
  bufferViews: { byteOffset?: number; byteLength: number }[];
  nodes: { name?: string; mesh?: number }[];
  meshes: { primitives: { attributes: Record<string, number>; indices: number }[] }[];
  extensions: { PALPATE_touchable_head?: Extension };
}
interface Extension {
  version: number;
  unit_mm: number;
  tool_radius_mm: number;
  forces_n: number[];
  status_names: string[];
  skin_region_names: string[];
  dents?: { force_n: number; radii_mm: number[] };
  frame: Frame;
  landmarks?: Record<string, { position_mm: number[]; confidence: number }>;
  provenance?: { input?: { name?: string; file?: string } };
}

const MAGIC = 0x46546c67; // "glTF"

class Reader {
  readonly doc: Document;
  private readonly binary: number;

  constructor(private readonly bytes: ArrayBuffer) {
    const view = new DataView(bytes);
    if (bytes.byteLength < 20 || view.getUint32(0, true) !== MAGIC)
      throw new Error("the file is not a GLB");
    const length = view.getUint32(12, true);
    this.doc = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length)));
    this.binary = 28 + length;
  }

  private offset(a: Accessor): number {
    return this.binary + (this.doc.bufferViews[a.bufferView].byteOffset ?? 0) + (a.byteOffset ?? 0);
  }
  floats(accessor: number, width: number): Float32Array {
    const a = this.doc.accessors[accessor];
    const at = this.offset(a);
    return at % 4 === 0
      ? new Float32Array(this.bytes, at, a.count * width)
      : new Float32Array(this.bytes.slice(at, at + 4 * a.count * width));
  }
  indices(accessor: number): Uint32Array {
    const a = this.doc.accessors[accessor];
    const at = this.offset(a);
    if (a.componentType === 5123) return Uint32Array.from(new Uint16Array(this.bytes, at, a.count));
    if (a.componentType === 5121) return Uint32Array.from(new Uint8Array(this.bytes, at, a.count));
    return at % 4 === 0
      ? new Uint32Array(this.bytes, at, a.count)
      : new Uint32Array(this.bytes.slice(at, at + 4 * a.count));
  }
}

/** x_head = rotation (scale x - origin); normals turn with it. */
function placed(reader: Reader, mesh: number, scale: number, frame: Frame): Surface {
  const primitive = reader.doc.meshes[mesh].primitives[0];
  const from = reader.floats(primitive.attributes["POSITION"], 3);
  const fromNormals = reader.floats(primitive.attributes["NORMAL"], 3);
  const [r0, r1, r2] = frame.rotation;
  const [ox, oy, oz] = frame.origin_mm;
  const positions = new Float32Array(from.length);
  const normals = new Float32Array(from.length);
  for (let i = 0; i < from.length; i += 3) {
    const x = scale * from[i] - ox;
    const y = scale * from[i + 1] - oy;
    const z = scale * from[i + 2] - oz;
    positions[i] = r0[0] * x + r0[1] * y + r0[2] * z;
    positions[i + 1] = r1[0] * x + r1[1] * y + r1[2] * z;
    positions[i + 2] = r2[0] * x + r2[1] * y + r2[2] * z;
    const [a, b, c] = [fromNormals[i], fromNormals[i + 1], fromNormals[i + 2]];
    normals[i] = r0[0] * a + r0[1] * b + r0[2] * c;
    normals[i + 1] = r1[0] * a + r1[1] * b + r1[2] * c;
    normals[i + 2] = r2[0] * a + r2[1] * b + r2[2] * c;
  }
  return { positions, normals, triangles: reader.indices(primitive.indices), count: from.length / 3 };
}

export function parseHead(bytes: ArrayBuffer): Head {
  const reader = new Reader(bytes);
  const e = reader.doc.extensions?.PALPATE_touchable_head;
  if (!e) throw new Error("the file is no touchable head; make one with `palpate build`");
  const skinMesh = reader.doc.nodes.find((n) => n.name === "skin")?.mesh ?? 0;
  const skullMesh = reader.doc.nodes.find((n) => n.name === "skull")?.mesh;
  const attributes = reader.doc.meshes[skinMesh].primitives[0].attributes;
  const column = (name: string) => reader.floats(attributes[name], 1);
  return {
    skin: placed(reader, skinMesh, e.unit_mm, e.frame),
    skull: skullMesh === undefined ? null : placed(reader, skullMesh, 1, e.frame),
    forces: e.forces_n,
    travel: e.forces_n.map((_, i) => column(`_U_${i + 1}`)),
    depth: column("_DEPTH"),
    error: column("_ERROR"),
    dents: e.dents && {
      radii: e.dents.radii_mm,
      share: e.dents.radii_mm.map((_, i) => column(`_DENT_${i + 1}`)),
    } || null,
    completed: "_COMPLETED" in attributes ? column("_COMPLETED") : null,
    region: column("_REGION"),
    status: column("_STATUS"),
    regionNames: e.skin_region_names,
    statusNames: e.status_names,
    toolRadius: e.tool_radius_mm,
    input: e.provenance?.input?.name ?? e.provenance?.input?.file ?? "",
    landmarks: Object.entries(e.landmarks ?? {}).map(([name, mark]) => ({
      name, position: toHead(e.frame, mark.position_mm), confidence: mark.confidence,
    })),
    frame: e.frame,
  };
}

function toHead(frame: Frame, scan: number[]): Vec3 {
  return frame.rotation.map((row) => row.reduce((sum, r, k) => sum + r * (scan[k] - frame.origin_mm[k]), 0)) as Vec3;
}

/** @param head the one that was fitted; the skull is put into its frame */
export function parseFit(bytes: ArrayBuffer, head: Head): Fit {
  const reader = new Reader(bytes);
  const attributes = reader.doc.meshes[1].primitives[0].attributes;
  const depth = reader.floats(attributes["_DEPTH"], 1);
  if (depth.length !== head.skin.count) throw new Error("it is of another head; the file on disk was replaced");
  return { skull: placed(reader, 0, 1, head.frame), depth, region: reader.floats(attributes["_REGION"], 1), fileDepth: head.depth };
}
