// The stage of the scene: renderer, sky, light with shadows, and the camera's lens.
import {
  Color,
  DirectionalLight,
  Fog,
  HemisphereLight,
  NeutralToneMapping,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  type Texture,
  Vector3,
  WebGLRenderer,
} from 'three';
import { kHorizonColour, MakeReflections, MakeSky, ShowClouds } from './sky';
import type { QualityLevel } from './quality';

const kToSun = new Vector3(-0.42, -0.36, 0.83).normalize();
const kAmbient = 0.85;
const kReflected = 0.35; // strength of the light from the sky's reflection, where there is one
const kSunAway = 60; // m
const kShadowEdge = 3; // texels of the shadow map over which a shadow's edge is soft
const kBiasTexels = 2.2; // texels by which surfaces are lifted against shadowing themselves
const kNearSpread = 9; // m around the focus with shadows, at least
const kFarSpread = 45; // and at most

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(55, 1, 0.1, 1500);
  readonly renderer: WebGLRenderer;

  private readonly m_sun = new DirectionalLight(new Color('#fff0d8'), 2.6);
  private readonly m_ambient = new HemisphereLight(new Color('#dcecff'), new Color('#c9b79d'));
  private readonly m_sky = MakeSky(kToSun);
  private m_reflections: Texture | null = null;
  private readonly m_right = new Vector3();
  private readonly m_up = new Vector3();
  private m_spread = 0;
  private m_shadowFrame = 0;
  private m_quality: QualityLevel | null = null;

  // smooths: anti-aliases edges.
  constructor(canvas: HTMLCanvasElement, smooths: boolean) {
    this.renderer = new WebGLRenderer({ canvas, antialias: smooths, powerPreference: 'high-performance' });
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.12;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.camera.up.set(0, 0, 1);

    this.scene.fog = new Fog(kHorizonColour, 45, 260);
    this.scene.environmentIntensity = kReflected;
    this.scene.add(this.m_sky);
    this.m_ambient.position.set(0, 0, 1);
    this.scene.add(this.m_ambient);

    this.m_sun.castShadow = true;
    this.m_sun.shadow.radius = kShadowEdge;
    this.m_sun.shadow.bias = -0.0006;
    this.m_right.crossVectors(new Vector3(0, 0, 1), kToSun).normalize();
    this.m_up.crossVectors(kToSun, this.m_right);
    this.scene.add(this.m_sun, this.m_sun.target);
  }

  ApplyQuality(quality: QualityLevel): void {
    this.m_quality = quality;
    if (quality.isRich) this.m_reflections ??= MakeReflections(this.renderer, kToSun);
    this.scene.environment = quality.isRich ? this.m_reflections : null;
    ShowClouds(this.m_sky, quality.isRich);
    this.m_ambient.intensity = quality.isRich ? kAmbient : kAmbient + kReflected;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, quality.maxPixelRatio) * quality.pixelShare);
    this.renderer.shadowMap.enabled = quality.shadowSize > 0;
    this.m_sun.castShadow = quality.shadowSize > 0;
    const shadow = this.m_sun.shadow;
    if (quality.shadowSize > 0 && shadow.mapSize.x !== quality.shadowSize) {
      shadow.mapSize.set(quality.shadowSize, quality.shadowSize);
      shadow.map?.dispose();
      shadow.map = null;
    }
    this.Resize();
  }

  Resize(): void {
    const width = window.innerWidth;
    const height = window.innerHeight;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // Portrait screens get a wider angle, as far as it does not distort.
    this.camera.fov = width >= height ? 55 : Math.min(75, 55 / Math.sqrt(width / height));
    this.camera.updateProjectionMatrix();
  }

  // Shadows cover an area around the focus that grows with the camera's distance.
  FocusLight(x: number, y: number, z: number, distance: number): void {
    const wished = Math.min(kFarSpread, Math.max(kNearSpread, 1.5 * distance));
    if (this.m_spread === 0 || Math.abs(wished - this.m_spread) > 0.2 * this.m_spread) this.SpreadShadows(wished);
    // Moves in whole texels; otherwise the edges of shadows would crawl as the camera moves.
    const texel = (2 * this.m_spread) / this.m_sun.shadow.mapSize.x;
    const target = this.m_sun.target.position.set(x, y, z);
    const right = target.dot(this.m_right);
    const up = target.dot(this.m_up);
    target.addScaledVector(this.m_right, Math.round(right / texel) * texel - right);
    target.addScaledVector(this.m_up, Math.round(up / texel) * texel - up);
    this.m_sun.position.copy(target).addScaledVector(kToSun, kSunAway);
    this.m_sun.shadow.normalBias = kBiasTexels * texel;
  }

  private SpreadShadows(spread: number): void {
    this.m_spread = spread;
    const lens = this.m_sun.shadow.camera;
    lens.left = lens.bottom = -spread;
    lens.right = lens.top = spread;
    lens.near = 1;
    lens.far = 2.2 * kSunAway;
    lens.updateProjectionMatrix();
  }

  Render(): void {
    const every = this.m_quality?.shadowEvery ?? 1;
    this.m_shadowFrame = (this.m_shadowFrame + 1) % every;
    if (this.m_shadowFrame === 0) this.renderer.shadowMap.needsUpdate = true;
    this.renderer.render(this.scene, this.camera);
  }
}

// Whether rendering is done in software, two orders of magnitude slower than a graphics card.
export function FindIsSoftware(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context?.getExtension('WEBGL_debug_renderer_info') ?? null;
  const name: unknown = context === null || names === null ? '' : context.getParameter(names.UNMASKED_RENDERER_WEBGL);
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(String(name));
}
