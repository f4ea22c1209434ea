// SPDX-License-Identifier: GPL-3.0-or-later
// How the skin is drawn: heat map, light, translucency, and the dent under the tool
// (docs/method/page.md). One vertex shader serves the depth pass and the colour pass.
import * as THREE from "three";

/** Of the stored dents; a file with more is drawn with its first. */
export const MOST_RADII = 16;

const vertex = /* glsl */ `
attribute float value;
varying vec3 vNormal;
varying vec3 vView;
varying float vValue;
varying float vKnown;
flat varying float vCode;

#ifdef DENT
uniform vec3 dentPoint;   // mm, on the undeformed skin
uniform vec3 dentNormal;  // outward
uniform float dentDepth;  // mm, 0: none
uniform float toolRadius; // mm
uniform float thickness;  // mm of tissue under the tool
uniform int dentCount;    // stored radii, 0: none
uniform float dentRadius[MOST_RADII]; // mm from the axis, ascending from 0
uniform float dentShare[MOST_RADII];  // travel of the skin there over the tool's

// Travel of the skin at a distance r from the axis, over the tool's depth. As the pressed tissue
// went down at this place, straight between the stored radii; nowhere above the tool.
float stored(float r) {
  float share = 0.0;
  for (int i = 1; i < MOST_RADII; ++i)
    if (i < dentCount && r >= dentRadius[i - 1] && r < dentRadius[i])
      share = mix(dentShare[i - 1], dentShare[i], (r - dentRadius[i - 1]) / (dentRadius[i] - dentRadius[i - 1]));
  float inside = toolRadius * toolRadius - r * r;
  return inside > 0.0 ? max(share, 1.0 - (toolRadius - sqrt(inside)) / dentDepth) : share;
}

// Where nothing is stored: inside the contact the skin follows the sphere, outside it falls off as
// an elastic half space does (Hertz), the faster the thinner the tissue over the bone.
float smoothed(float r, float a) {
  if (r <= a) return 1.0 - 0.5 * r * r / (a * a);
  float q = a / r;
  float outside = ((2.0 - 1.0 / (q * q)) * asin(q) + sqrt(1.0 - q * q) / q) / 3.14159265;
  return outside * exp(-(r - a) / thickness);
}

float profile(float r, float a) {
  return dentCount > 0 ? stored(r) : smoothed(r, a);
}
#endif

void main() {
  vec3 p = position;
  vec3 n = normal;
#ifdef DENT
  if (dentDepth > 0.0) {
    float a = sqrt(toolRadius * dentDepth);
    vec3 away = p - dentPoint;
    vec3 tangent = away - dot(away, dentNormal) * dentNormal;
    // From the axis; skin far below or above it, such as the other side of the head, stays.
    float r = dentCount > 0 ? length(tangent) : length(away);
    float facing = smoothstep(0.0, 0.35, dot(n, dentNormal));
    if (length(away) < a + 6.0 * thickness && facing > 0.0) {
      float u = dentDepth * facing * profile(r, a);
      float h = dentCount > 0 ? 1.0 : 0.05 * a;
      float slope = dentDepth * facing * (profile(r + h, a) - profile(max(r - h, 0.0), a)) / (2.0 * h);
      if (dot(tangent, tangent) > 1e-6) n = normalize(n + slope * normalize(tangent));
      p -= u * dentNormal;
    }
  }
#endif
  vec4 view = modelViewMatrix * vec4(p, 1.0);
  vView = view.xyz;
  vNormal = normalMatrix * n;
  vKnown = value > -1.0e29 ? 1.0 : 0.0;
  vValue = value * vKnown;
  vCode = value;
  gl_Position = projectionMatrix * view;
}`;

const fragment = /* glsl */ `
uniform sampler2D colors;
uniform vec3 missing;
uniform float low;
uniform float high;
uniform int scale;  // 0 linear, 1 logarithmic, 2 categories
uniform float categories;
uniform float opacity;
varying vec3 vNormal;
varying vec3 vView;
varying float vValue;
varying float vKnown;
flat varying float vCode;

vec3 paint() {
  if (scale == 2) return texture2D(colors, vec2((vCode + 0.5) / categories, 0.5)).rgb;
  float value = vValue / max(vKnown, 1e-3);
  float t = scale == 1 ? log(max(value, 1e-6) / low) / log(high / low) : (value - low) / (high - low);
  t = clamp(t, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0;
  return mix(missing, texture2D(colors, vec2(t, 0.5)).rgb, smoothstep(0.35, 0.65, vKnown));
}

void main() {
  vec3 n = normalize(vNormal);
  vec3 eye = normalize(-vView);
  if (dot(n, eye) < 0.0) n = -n;
  vec3 key = normalize(vec3(0.35, 0.55, 0.75));
  float light = 0.50 + 0.42 * max(dot(n, key), 0.0) + 0.14 * n.y;
  float gloss = pow(max(dot(n, normalize(key + eye)), 0.0), 28.0);
  vec3 color = paint() * light + 0.07 * gloss;
  // Seen at a slant, more of a translucent skin lies in the way.
  float rim = pow(1.0 - max(dot(n, eye), 0.0), 2.0);
  gl_FragColor = vec4(color, opacity < 1.0 ? mix(opacity, min(1.0, opacity + 0.45), rim) : 1.0);
}`;

export interface SkinMaterials {
  color: THREE.ShaderMaterial;
  /** depth only, drawn first: of translucent skin just the nearest layer is seen */
  depth: THREE.ShaderMaterial;
  uniforms: Record<string, THREE.IUniform>;
  /** Whether there is a dent to draw: without one the shader has nothing of it, which is a third of a frame in software. */
  dented(on: boolean): void;
}

export function makeSkinMaterials(): SkinMaterials {
  const uniforms: Record<string, THREE.IUniform> = {
    dentPoint: { value: new THREE.Vector3() },
    dentNormal: { value: new THREE.Vector3(0, 0, 1) },
    dentDepth: { value: 0 },
    toolRadius: { value: 8 },
    thickness: { value: 10 },
    dentCount: { value: 0 },
    dentRadius: { value: new Array<number>(MOST_RADII).fill(0) },
    dentShare: { value: new Array<number>(MOST_RADII).fill(0) },
    colors: { value: null },
    missing: { value: new THREE.Color(0.6, 0.6, 0.6) },
    low: { value: 0 },
    high: { value: 1 },
    scale: { value: 0 },
    categories: { value: 1 },
    opacity: { value: 1 },
  };
  const defines: Record<string, number> = { MOST_RADII };
  const shared = { uniforms, vertexShader: vertex, side: THREE.DoubleSide };
  const color = new THREE.ShaderMaterial({ ...shared, fragmentShader: fragment,
                                           depthFunc: THREE.LessEqualDepth });
  const depth = new THREE.ShaderMaterial({
    ...shared,
    fragmentShader: "void main() { gl_FragColor = vec4(1.0); }",
    colorWrite: false,
  });
  color.defines = depth.defines = defines;
  const dented = (on: boolean) => {
    if (on === "DENT" in defines) return;
    if (on) defines.DENT = 1;
    else delete defines.DENT;
    color.needsUpdate = depth.needsUpdate = true; // both programs are kept: compiled once each
  };
  return { uniforms, color, depth, dented };
}

/** Solid things: skull, tool, arrow. Same light as the skin. */
export function makeSolidMaterial(color: THREE.ColorRepresentation, gloss: number): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    uniforms: { color: { value: new THREE.Color().set(color).convertLinearToSRGB() }, gloss: { value: gloss } },
    vertexShader: /* glsl */ `
varying vec3 vNormal;
varying vec3 vView;
void main() {
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vView = view.xyz;
  vNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * view;
}`,
    fragmentShader: /* glsl */ `
uniform vec3 color;
uniform float gloss;
varying vec3 vNormal;
varying vec3 vView;
void main() {
  vec3 n = normalize(vNormal);
  vec3 eye = normalize(-vView);
  if (dot(n, eye) < 0.0) n = -n;
  vec3 key = normalize(vec3(0.35, 0.55, 0.75));
  float light = 0.45 + 0.5 * max(dot(n, key), 0.0) + 0.1 * n.y;
  float shine = pow(max(dot(n, normalize(key + eye)), 0.0), 40.0);
  gl_FragColor = vec4(color * light + gloss * shine, 1.0);
}`,
    side: THREE.DoubleSide,
  });
}
