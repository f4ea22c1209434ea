// SPDX-License-Identifier: GPL-3.0-or-later
// The picture: skin, skull, tool, arrow, and the eye that goes round the head.
import * as THREE from "three";
import type { Head, Surface, Vec3 } from "./glb";
import type { TouchState } from "./link";
import type { HeatMap } from "./maps";
import type { Dent } from "./dent";
import { bytesOf } from "./palette";
import { makeSkinMaterials, makeSolidMaterial, MOST_RADII, type SkinMaterials } from "./skin_material";

const NO_VALUE = -1e30;
const ARROW_MM_PER_N = 12;

export class View {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(30, 1, 10, 3000);
  private readonly skin = makeSkinMaterials();
  private values: THREE.BufferAttribute | null = null;
  private skullMesh: THREE.Mesh | null = null;
  /** A point of skin, drawn while the head is on its way: the graphics build the skin's program meanwhile. */
  private readonly rehearsal = pointOfSkin(this.skin);
  private depthMesh: THREE.Mesh | null = null;
  private readonly tool: THREE.Mesh;
  private readonly arrow = new THREE.Group();
  private readonly shaft: THREE.Mesh;
  private readonly tip: THREE.Mesh;
  private readonly target = new THREE.Vector3();
  private distance = 600;
  private yaw = 0.35;
  private pitch = 0.05;
  private reach = 130; // mm, radius of the head
  private dirty = true;
  private last = 0;
  private head: Head | null = null;
  /** no graphics card: fewer pixels, so that it stays fluent */
  readonly software: boolean;
  /** ms from one drawn frame to the next while something moves */
  frameTime = 0;
  frames = 0;
  /** CSS pixels at the top that the controls cover: the head is placed below them */
  private inset = 0;
  showDent = true;
  showArrow = true;
  /** after each frame */
  drawn: () => void = () => {};

  /** what is drawn on; in the place of the canvas that was given */
  readonly canvas: HTMLCanvasElement;

  constructor(placeholder: HTMLCanvasElement) {
    const graphics = openGraphics(placeholder);
    const canvas = (this.canvas = graphics.canvas);
    this.software = graphics.software;
    this.renderer = new THREE.WebGLRenderer({ canvas, context: graphics.context });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // shaders write display colours
    this.renderer.setClearAlpha(0);
    this.tool = new THREE.Mesh(new THREE.SphereGeometry(1, 40, 28), makeSolidMaterial("#e8eaf0", 0.5));
    this.tool.visible = false;
    const red = makeSolidMaterial("#e0442e", 0.2);
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1.1, 1.1, 1, 20).translate(0, 0.5, 0), red);
    this.tip = new THREE.Mesh(new THREE.ConeGeometry(3, 8, 24).translate(0, 4, 0), red);
    this.arrow.add(this.shaft, this.tip);
    this.arrow.visible = false;
    this.scene.add(this.tool, this.arrow, this.rehearsal);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    const loop = (now: number) => {
      requestAnimationFrame(loop);
      this.draw(now);
    };
    requestAnimationFrame(loop);
  }

  setHead(head: Head): void {
    this.head = head;
    this.scene.remove(this.rehearsal);
    this.rehearsal.geometry.dispose();
    const g = surfaceGeometry(head.skin);
    this.values = new THREE.BufferAttribute(new Float32Array(head.skin.count).fill(NO_VALUE), 1);
    g.setAttribute("value", this.values);
    g.computeBoundingSphere();
    const sphere = g.boundingSphere!;
    this.target.copy(sphere.center);
    this.reach = sphere.radius;
    this.depthMesh = new THREE.Mesh(g, this.skin.depth);
    this.depthMesh.renderOrder = 2;
    const color = new THREE.Mesh(g, this.skin.color);
    color.renderOrder = 3;
    this.depthMesh.frustumCulled = color.frustumCulled = false;
    this.scene.add(this.depthMesh, color);
    this.setSkull(head.skull);
    this.fit();
    this.dirty = true;
  }

  setSkull(skull: Surface | null): void {
    const old = this.skullMesh;
    if (old) this.scene.remove(old);
    old?.geometry.dispose();
    this.skullMesh = skull && new THREE.Mesh(surfaceGeometry(skull), old?.material ?? makeSolidMaterial("#e9e0c9", 0.05));
    if (this.skullMesh) {
      this.skullMesh.renderOrder = 1;
      this.skullMesh.visible = this.opacity < 1; // behind opaque skin it would be drawn for nothing
      this.scene.add(this.skullMesh);
    }
    this.touch();
  }

  set covered(pixels: number) {
    if (pixels === this.inset) return;
    this.inset = pixels;
    this.canvas.parentElement?.style.setProperty("--covered", `${pixels}px`);
    if (this.head) this.fit();
  }

  /** The whole head in the picture. */
  fit(): void {
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const free = 1 - this.inset / Math.max(1, this.canvas.clientHeight);
    const narrow = Math.atan(Math.tan(half) * Math.min(free, this.camera.aspect));
    this.distance = (0.94 * this.reach) / Math.sin(narrow);
    this.touch();
  }

  paint(map: HeatMap, sequential: Uint8Array<ArrayBuffer>, missing: THREE.Color): void {
    if (!this.values) return;
    const u = this.skin.uniforms;
    const to = this.values.array as Float32Array;
    for (let i = 0; i < to.length; ++i)
      to[i] = Number.isNaN(map.values[i]) ? NO_VALUE : map.values[i];
    this.values.needsUpdate = true;
    const codes = map.categories;
    const bytes = codes ? bytesOf(codes.map((c) => c.color)) : sequential;
    const texture = new THREE.DataTexture(bytes, bytes.length / 4, 1, THREE.RGBAFormat);
    texture.minFilter = texture.magFilter = codes ? THREE.NearestFilter : THREE.LinearFilter;
    texture.needsUpdate = true;
    (u.colors.value as THREE.Texture | null)?.dispose();
    u.colors.value = texture;
    u.categories.value = bytes.length / 4;
    u.missing.value = missing;
    u.low.value = map.low;
    u.high.value = map.high;
    u.scale.value = codes ? 2 : map.logarithmic ? 1 : 0;
    this.touch();
  }

  set opacity(value: number) {
    this.skin.uniforms.opacity.value = value;
    this.skin.color.transparent = value < 1;
    if (this.skullMesh) this.skullMesh.visible = value < 1;
    this.touch();
  }
  get opacity(): number {
    return this.skin.uniforms.opacity.value as number;
  }

  /**
   * @param thickness mm of tissue under the tool
   * @param dent as it is stored for the touched place; null: a smooth one is drawn
   */
  showTouch(state: TouchState, radius: number, thickness: number, profile: Dent | null, toolVisible: boolean): void {
    const u = this.skin.uniforms;
    u.dentCount.value = profile ? Math.min(profile.radii.length, MOST_RADII) : 0;
    for (let i = 0; i < u.dentCount.value; ++i) {
      u.dentRadius.value[i] = profile!.radii[i];
      u.dentShare.value[i] = profile!.share[i];
    }
    const dent = this.showDent && state.inContact ? state.depth : 0;
    const was = [this.tool.visible, this.arrow.visible, u.dentDepth.value, ...this.tool.position.toArray()];
    u.dentDepth.value = dent;
    this.skin.dented(dent > 0);
    (u.dentPoint.value as THREE.Vector3).fromArray(state.point);
    (u.dentNormal.value as THREE.Vector3).fromArray(state.inContact ? state.normal : [0, 0, 1]);
    u.toolRadius.value = radius;
    u.thickness.value = thickness;
    this.tool.visible = toolVisible;
    this.tool.position.fromArray(state.tool);
    this.tool.scale.setScalar(radius);
    const newtons = Math.hypot(...state.force);
    this.arrow.visible = this.showArrow && toolVisible && newtons > 0.02;
    if (this.arrow.visible) {
      const along = new THREE.Vector3().fromArray(state.force).divideScalar(newtons);
      const length = Math.max(1, ARROW_MM_PER_N * newtons);
      this.arrow.position.fromArray(state.tool).addScaledVector(along, radius);
      this.arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
      this.shaft.scale.set(1, length, 1);
      this.tip.position.set(0, length, 0);
    }
    const is = [this.tool.visible, this.arrow.visible, dent, ...this.tool.position.toArray()];
    if (is.some((x, i) => x !== was[i])) this.touch();
  }

  turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + pitch));
    this.touch();
  }
  zoom(factor: number): void {
    this.distance = Math.min(8 * this.reach, Math.max(1.2 * this.reach, this.distance * factor));
    this.touch();
  }
  /** Looks from outside along a direction. */
  lookFrom(direction: Vec3): void {
    const d = new THREE.Vector3().fromArray(direction).normalize();
    this.yaw = Math.atan2(d.x, d.z);
    this.pitch = Math.asin(Math.min(1, Math.max(-1, d.y)));
    this.turn(0, 0);
  }

  /** Ray through a place on the canvas, in CSS pixels. */
  ray(x: number, y: number): { origin: Vec3; direction: Vec3 } {
    this.placeCamera();
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector3(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2, 0.5);
    const direction = at.unproject(this.camera).sub(this.camera.position).normalize();
    return { origin: this.camera.position.toArray() as Vec3, direction: direction.toArray() as Vec3 };
  }
  /** Where a point of the head is on the canvas, in CSS pixels of the page. */
  place(point: Vec3): [number, number] {
    this.placeCamera();
    const box = this.canvas.getBoundingClientRect();
    const p = new THREE.Vector3().fromArray(point).project(this.camera);
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }

  /** Where it is seen from. */
  eye(): Vec3 {
    this.placeCamera();
    return this.camera.position.toArray() as Vec3;
  }
  /** Directions of the picture in the head's frame; `back` is towards the eye. */
  axes(): { right: Vec3; up: Vec3; back: Vec3 } {
    this.placeCamera();
    const [right, up, back] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, back);
    return { right: right.toArray() as Vec3, up: up.toArray() as Vec3, back: back.toArray() as Vec3 };
  }

  /** Where the head turns about, in CSS pixels of the page; the cross is there. */
  middle(): [number, number] {
    return this.place(this.target.toArray() as Vec3);
  }

  touch(): void {
    this.dirty = true;
  }

  /** Mean ms of `count` frames, each waited for. */
  measure(count: number): number {
    const gl = this.renderer.getContext();
    const pixel = new Uint8Array(4);
    const start = performance.now();
    for (let i = 0; i < count; ++i) {
      this.yaw += 0.01;
      this.render();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    this.touch();
    return (performance.now() - start) / count;
  }

  private placeCamera(): void {
    const c = Math.cos(this.pitch);
    this.camera.position.set(
      this.target.x + this.distance * c * Math.sin(this.yaw),
      this.target.y + this.distance * Math.sin(this.pitch),
      this.target.z + this.distance * c * Math.cos(this.yaw),
    );
    this.camera.up.set(0, 1, 0);
    this.camera.lookAt(this.target);
    this.camera.near = Math.max(5, this.distance - 3 * this.reach);
    this.camera.far = this.distance + 3 * this.reach;
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w > 0 && h > 0) this.camera.setViewOffset(w, h, 0, -this.inset / 2, w, h);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w === 0 || h === 0) return;
    const before = this.camera.aspect;
    this.renderer.setPixelRatio(this.software ? 0.75 : Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    if (before !== this.camera.aspect && this.head) this.fit();
    this.dirty = true;
  }

  private render(): void {
    this.placeCamera();
    if (this.depthMesh) this.depthMesh.visible = this.opacity < 1;
    this.renderer.render(this.scene, this.camera);
  }

  private draw(now: number): void {
    if (!this.dirty) {
      this.last = 0;
      return;
    }
    this.dirty = false;
    this.render();
    this.drawn();
    ++this.frames;
    if (this.last > 0) {
      const ms = now - this.last;
      this.frameTime = this.frameTime === 0 ? ms : 0.9 * this.frameTime + 0.1 * ms;
    }
    this.last = now;
  }
}

/**
 * Smooth edges on a graphics card, none where there is none. What draws is known only with a context, which keeps
 * the edges it was opened with; where it draws in software a second one costs much, so the first is kept there.
 */
function openGraphics(canvas: HTMLCanvasElement): { canvas: HTMLCanvasElement; context: WebGL2RenderingContext; software: boolean } {
  const wish: WebGLContextAttributes = { alpha: true, powerPreference: "high-performance" };
  const first = canvas.getContext("webgl2", { ...wish, antialias: false });
  if (!first) throw new Error("this browser draws no WebGL 2: switch hardware acceleration on, or use another one");
  const info = first.getExtension("WEBGL_debug_renderer_info");
  const name = String(first.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : first.RENDERER));
  if (/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name)) return { canvas, context: first, software: true };
  const smooth = canvas.cloneNode() as HTMLCanvasElement;
  const context = smooth.getContext("webgl2", { ...wish, antialias: true });
  if (!context) return { canvas, context: first, software: false };
  canvas.replaceWith(smooth);
  first.getExtension("WEBGL_lose_context")?.loseContext();
  return { canvas: smooth, context, software: false };
}

/** A triangle without area, in every other way as the head is drawn. */
function pointOfSkin(skin: SkinMaterials): THREE.Mesh {
  const three = new Float32Array(9);
  const g = surfaceGeometry({ positions: three, normals: three, triangles: new Uint32Array([0, 1, 2]), count: 3 });
  g.setAttribute("value", new THREE.BufferAttribute(new Float32Array(3), 1));
  const texture = new THREE.DataTexture(new Uint8Array(8), 2, 1, THREE.RGBAFormat);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  skin.uniforms.colors.value = texture; // until paint() puts the map's there
  const mesh = new THREE.Mesh(g, skin.color);
  mesh.frustumCulled = false;
  return mesh;
}

function surfaceGeometry(s: Surface): THREE.BufferGeometry {
  const g = new THREE.BufferGeometry();
  g.setAttribute("position", new THREE.BufferAttribute(s.positions, 3));
  g.setAttribute("normal", new THREE.BufferAttribute(s.normals, 3));
  g.setIndex(new THREE.BufferAttribute(s.triangles, 1));
  return g;
}
