// The sky: a gradient without a texture, and the light that comes from it.
import {
  BackSide,
  Color,
  Mesh,
  PMREMGenerator,
  Scene,
  ShaderMaterial,
  SphereGeometry,
  type Texture,
  type Vector3,
  type WebGLRenderer,
} from 'three';

export const kHorizonColour = new Color('#cfe6f5');
const kZenithColour = new Color('#3d8fe0');
const kNadirColour = new Color('#8fa6c4');
const kSunColour = new Color('#fff1d6');

const kCloudiness = 0.75;
const kReflectionSize = 64; // texels per edge of the cube map; the sky has no fine detail

const kVertexShader = `
varying vec3 vDirection;
void main() {
  vDirection = position;
  vec4 place = projectionMatrix * mat4(mat3(modelViewMatrix)) * vec4(position, 1.0);
  gl_Position = place.xyww;
}`;

const kFragmentShader = `
uniform vec3 horizon;
uniform vec3 zenith;
uniform vec3 nadir;
uniform vec3 sun;
uniform vec3 toSun;
uniform float clouds;
varying vec3 vDirection;

float Hash(vec2 p) { return fract(sin(dot(p, vec2(127.1, 311.7))) * 43758.5453); }
float Noise(vec2 p) {
  vec2 cell = floor(p), part = fract(p);
  part = part * part * (3.0 - 2.0 * part);
  return mix(mix(Hash(cell), Hash(cell + vec2(1, 0)), part.x),
             mix(Hash(cell + vec2(0, 1)), Hash(cell + vec2(1, 1)), part.x), part.y);
}
float Clouds(vec2 p) {
  return 0.5 * Noise(p) + 0.25 * Noise(2.1 * p + 7.0) + 0.125 * Noise(4.3 * p + 3.0) + 0.0625 * Noise(8.7 * p);
}

void main() {
  vec3 d = normalize(vDirection);
  float up = max(d.z, 0.0);
  vec3 colour = d.z > 0.0 ? mix(horizon, zenith, 1.0 - exp(-2.8 * up)) : mix(horizon, nadir, smoothstep(0.0, 0.7, -d.z));
  if (d.z > 0.02 && clouds > 0.0) {
    float cover = smoothstep(0.46, 0.78, Clouds(1.6 * d.xy / (d.z + 0.12)));
    colour = mix(colour, vec3(1.0), clouds * cover * smoothstep(0.02, 0.25, d.z));
  }
  float glow = max(dot(d, toSun), 0.0);
  colour += sun * (0.22 * pow(glow, 12.0) + 0.5 * pow(glow, 220.0));
  gl_FragColor = vec4(colour, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}`;

// toSun: unit vector.
export function MakeSky(toSun: Vector3): Mesh<SphereGeometry, ShaderMaterial> {
  const material = new ShaderMaterial({
    uniforms: {
      horizon: { value: kHorizonColour },
      zenith: { value: kZenithColour },
      nadir: { value: kNadirColour },
      sun: { value: kSunColour },
      toSun: { value: toSun },
      clouds: { value: 0 },
    },
    vertexShader: kVertexShader,
    fragmentShader: kFragmentShader,
    side: BackSide,
    depthWrite: false,
  });
  const sky = new Mesh(new SphereGeometry(1, 32, 16), material);
  sky.frustumCulled = false;
  sky.renderOrder = 1; // after solid objects, which hide most of it
  return sky;
}

// Clouds are too slow for software rendering.
export function ShowClouds(sky: Mesh<SphereGeometry, ShaderMaterial>, isShown: boolean): void {
  sky.material.uniforms.clouds.value = isShown ? kCloudiness : 0;
}

// The environment that smooth surfaces reflect; made once.
export function MakeReflections(renderer: WebGLRenderer, toSun: Vector3): Texture {
  const scene = new Scene();
  const sky = MakeSky(toSun);
  sky.scale.setScalar(50);
  sky.material.vertexShader = kVertexShader.replace('place.xyww', 'place');
  scene.add(sky);
  const generator = new PMREMGenerator(renderer);
  const texture = generator.fromScene(scene, 0.04, 0.1, 100, { size: kReflectionSize }).texture;
  generator.dispose();
  return texture;
}
