// The material of platforms, walls and hills: plain, with a faint chequer and thin lines every metre and every five
// metres, computed from the position in the world. The lines show speed, and no texture is loaded.
import { Color, MeshStandardMaterial } from 'three';

const kVertexHead = `
varying vec3 vWorldPlace;
varying vec3 vWorldNormal;
`;
const kVertexBody = `
vWorldPlace = (modelMatrix * vec4(transformed, 1.0)).xyz;
vWorldNormal = mat3(modelMatrix) * objectNormal;
`;
const kFragmentHead = `
varying vec3 vWorldPlace;
varying vec3 vWorldNormal;

// Share of a pixel of width w at p that lies on lines of width t at whole numbers.
float Line(vec2 p, float t) {
  vec2 w = fwidth(p);
  vec2 away = abs(fract(p - 0.5) - 0.5);
  vec2 cover = clamp((0.5 * t + 0.5 * w - away) / w, 0.0, 1.0) * min(vec2(1.0), t / w + 0.3);
  return max(cover.x, cover.y) * (1.0 - smoothstep(0.25, 0.7, max(w.x, w.y)));
}
// A chequer of unit squares, -1 to 1, filtered over the pixel.
float Chequer(vec2 p) {
  vec2 w = fwidth(p) + 0.001;
  vec2 filtered = 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
  return filtered.x * filtered.y * (1.0 - smoothstep(0.4, 1.2, max(w.x, w.y)));
}
`;
const kFragmentBody = `
vec3 side = abs(normalize(vWorldNormal));
vec2 place = side.z > 0.6 ? vWorldPlace.xy : side.x > side.y ? vWorldPlace.yz : vWorldPlace.xz;
diffuseColor.rgb *= 1.0 + 0.025 * Chequer(place);
diffuseColor.rgb = mix(diffuseColor.rgb, diffuseColor.rgb * 0.80, 0.55 * Line(place, 0.02));
diffuseColor.rgb = mix(diffuseColor.rgb, diffuseColor.rgb * 0.66, 0.75 * Line(place / 5.0, 0.008));
`;

export function MakeGroundMaterial(colour: string, usesVertexColours = false): MeshStandardMaterial {
  const material = new MeshStandardMaterial({
    color: new Color(colour),
    roughness: 0.82,
    metalness: 0,
    vertexColors: usesVertexColours,
  });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader =
      kVertexHead + shader.vertexShader.replace('#include <fog_vertex>', `#include <fog_vertex>\n${kVertexBody}`);
    shader.fragmentShader =
      kFragmentHead +
      shader.fragmentShader.replace('#include <color_fragment>', `#include <color_fragment>\n${kFragmentBody}`);
  };
  material.customProgramCacheKey = () => 'ground';
  return material;
}
