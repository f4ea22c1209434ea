// SPDX-License-Identifier: GPL-3.0-or-later
// The head and the tool as the hand has them: the touched place in the middle, towards the user.
import {
  AmbientLight, BufferAttribute, BufferGeometry, DirectionalLight, Matrix4, Mesh, MeshStandardMaterial,
  PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from "three";

export class Picture {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 10, 3000);
  private readonly tool: Mesh;
  private head: Mesh | null = null;
  private radius = 0;
  private next: Float32Array | null = null; // to be drawn

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.tool = new Mesh(new SphereGeometry(1, 48, 24), new MeshStandardMaterial({ color: 0xf0b45a, roughness: 0.4 }));
    this.tool.visible = false;
    const sun = new DirectionalLight(0xffffff, 2.4);
    sun.position.set(-200, 400, 500);
    this.scene.add(new AmbientLight(0xffffff, 0.8), sun, this.tool);
    this.camera.position.set(0, 0, 520);
  }

  /** Fetches the skin: two counts, points, triangles; nothing else is in it. */
  async load(): Promise<void> {
    if (this.head) return;
    const bytes = await (await fetch("skin.bin")).arrayBuffer();
    const counts = new Uint32Array(bytes, 0, 2);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(bytes, 8, 3 * counts[0]), 3));
    geometry.setIndex(new BufferAttribute(new Uint32Array(bytes, 8 + 12 * counts[0], 3 * counts[1]), 1));
    geometry.computeVertexNormals();
    this.head = new Mesh(geometry, new MeshStandardMaterial({ color: 0xd8b8a4, roughness: 0.75 }));
    this.head.matrixAutoUpdate = false;
    this.head.visible = false;
    this.scene.add(this.head);
    this.draw();
  }

  /** Tool (3), user's axes in the head (9, columns), the place in the head (3), tool radius. Where
   * they come faster than the page can draw, only the newest is drawn. */
  show(numbers: Float32Array): void {
    if (numbers.length !== 16) return;
    if (!this.next) requestAnimationFrame(() => this.step());
    this.next = numbers;
  }

  private step(): void {
    const n = this.next;
    this.next = null;
    if (!n || !this.head) return;
    const x = new Vector3(n[3], n[4], n[5]);
    const y = new Vector3(n[6], n[7], n[8]);
    const z = new Vector3(n[9], n[10], n[11]);
    const toUser = new Matrix4().makeBasis(x, y, z).transpose();
    const at = new Vector3(n[12], n[13], n[14]);
    this.head.matrix.copy(toUser).multiply(new Matrix4().makeTranslation(-at.x, -at.y, -at.z));
    this.head.matrixWorldNeedsUpdate = true;
    this.head.visible = true;
    this.tool.position.set(n[0], n[1], n[2]).sub(at).applyMatrix4(toUser);
    this.radius = n[15];
    this.tool.scale.setScalar(this.radius);
    this.tool.visible = true;
    this.draw();
  }

  draw(): void {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w === 0 || h === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    // Seen from a little above and beside, so that depth shows.
    this.camera.position.set(140, 120, 520);
    this.camera.lookAt(0, 0, -60);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
  }
}
