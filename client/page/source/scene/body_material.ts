// The material of soft bodies: smooth, with a glow at the rim and a pattern fixed to the rest shape, which makes
// rolling and stretching visible.
import { Color, DoubleSide, FrontSide, MeshStandardMaterial, Vector3 } from 'three';
import type { Blueprint } from 'wobble-client';

export enum Pattern {
  Plain = 0, // players
  Ball = 1, // sectors, as on a beach ball
  Bands = 2,
  Check = 3, // cloth
}

const kVertexHead = `
attribute vec3 rest;
varying vec3 vRest;
`;
const kFragmentHead = `
varying vec3 vRest;
uniform int pattern;
uniform vec3 restSize;
uniform float shown;
// Bayer 1973: an even order of the pixels of a square.
const float kOrder[16] = float[16](0.5, 8.5, 2.5, 10.5, 12.5, 4.5, 14.5, 6.5, 3.5, 11.5, 1.5, 9.5, 15.5, 7.5, 13.5, 5.5);

float Step(float x) { float w = max(fwidth(x), 1e-4); return clamp(0.5 + x / w, 0.0, 1.0); }
float Wave(float x) { return Step(sin(x)); }

float FindPattern() {
  if (pattern == 1) {
    vec3 d = normalize(vRest);
    float cap = Step(abs(d.z) - 0.93);
    float sector = mix(Wave(3.0 * atan(d.y, d.x)), 0.5, smoothstep(0.75, 1.6, fwidth(3.0 * atan(d.y, d.x))));
    return max(sector, cap);
  }
  if (pattern == 2) {
    vec3 p = vRest / restSize;
    return Wave(9.0 * (p.z + 0.35 * p.x));
  }
  if (pattern == 3) {
    vec2 p = (restSize.z > 0.05 ? (restSize.x > restSize.y ? vRest.xz : vRest.yz) : vRest.xy) * 7.85;
    return 0.5 * Wave(p.x) + 0.5 * Wave(p.y);
  }
  return 0.0;
}
`;
const kFragmentColour = `
if (16.0 * shown < kOrder[int(mod(gl_FragCoord.x, 4.0)) + 4 * int(mod(gl_FragCoord.y, 4.0))]) discard;
diffuseColor.rgb = mix(diffuseColor.rgb, mix(diffuseColor.rgb, vec3(1.0), pattern == 3 ? 0.62 : 0.72), FindPattern());
`;
// Light shines through thin edges: brightest where the surface turns away.
const kFragmentGlow = `
{
  float away = 1.0 - abs(dot(normalize(normal), normalize(vViewPosition)));
  totalEmissiveRadiance += diffuseColor.rgb * (0.05 + 0.42 * away * away * away);
}
`;

export class BodyMaterial {
  readonly material: MeshStandardMaterial;
  private readonly m_pattern = { value: 0 };
  private readonly m_shown = { value: 1 };
  private readonly m_restSize = { value: new Vector3(1, 1, 1) };

  constructor() {
    this.material = new MeshStandardMaterial({ roughness: 0.34, metalness: 0, shadowSide: FrontSide });
    this.material.onBeforeCompile = (shader) => {
      shader.uniforms.pattern = this.m_pattern;
      shader.uniforms.restSize = this.m_restSize;
      shader.uniforms.shown = this.m_shown;
      shader.vertexShader =
        kVertexHead + shader.vertexShader.replace('#include <begin_vertex>', '#include <begin_vertex>\nvRest = rest;');
      shader.fragmentShader =
        kFragmentHead +
        shader.fragmentShader
          .replace('#include <color_fragment>', `#include <color_fragment>\n${kFragmentColour}`)
          .replace('#include <emissivemap_fragment>', `#include <emissivemap_fragment>\n${kFragmentGlow}`);
    };
    this.material.customProgramCacheKey = () => 'body';
  }

  // The share of its pixels that are drawn, 0 to 1. Without blending, nothing needs sorting or another program.
  set shown(share: number) {
    this.m_shown.value = share;
  }

  Dress(blueprint: Blueprint, isPlayer: boolean, colour: Color): void {
    const size = FindRestSize(blueprint.rest);
    this.m_restSize.value.copy(size);
    this.m_pattern.value = isPlayer ? Pattern.Plain : ChoosePattern(blueprint, size);
    this.material.color.copy(colour);
    this.material.roughness = blueprint.isOpen ? 0.75 : 0.34;
    const side = blueprint.isOpen ? DoubleSide : FrontSide;
    if (this.material.side !== side) this.material.needsUpdate = true;
    this.material.side = this.material.shadowSide = side;
  }
}

function ChoosePattern(blueprint: Blueprint, size: Vector3): Pattern {
  if (blueprint.isOpen) return Pattern.Check;
  const isRound = Math.max(size.x, size.y, size.z) < 1.08 * Math.min(size.x, size.y, size.z);
  return isRound && IsSphere(blueprint.rest) ? Pattern.Ball : Pattern.Bands;
}

// Half extents, m.
function FindRestSize(rest: Float32Array): Vector3 {
  const size = new Vector3(1e-3, 1e-3, 1e-3);
  for (let i = 0; i < rest.length; i += 3) {
    size.x = Math.max(size.x, Math.abs(rest[i]));
    size.y = Math.max(size.y, Math.abs(rest[i + 1]));
    size.z = Math.max(size.z, Math.abs(rest[i + 2]));
  }
  return size;
}

function IsSphere(rest: Float32Array): boolean {
  let least = Infinity;
  let most = 0;
  for (let i = 0; i < rest.length; i += 3) {
    const radius = Math.hypot(rest[i], rest[i + 1], rest[i + 2]);
    least = Math.min(least, radius);
    most = Math.max(most, radius);
  }
  return most < 1.1 * least;
}
