// What a player has chosen for the page, from one visit to the next. What is kept may be of another version or damaged:
// a field that is not understood has its default.
import { CameraMode } from './scene/camera';
import { kQualityLevels } from './scene/quality';
import { Keep, ReadKept } from './storage';

const kKey = 'wobble.settings';
const kZoomRange = [0.3, 5];

export interface Settings {
  quality: number | null; // level; null: adapts to the time that frames take
  camera: CameraMode; // with a body
  zoom: number; // factor on the camera's distance
  isCalm: boolean; // less motion than the system asks for
}

const kDefaults: Settings = { quality: null, camera: CameraMode.Follow, zoom: 1, isCalm: false };

export function ReadSettings(): Settings {
  return TakeSettings(ReadKept(kKey));
}

export function KeepSettings(settings: Settings): void {
  Keep(kKey, JSON.stringify(settings));
}

export function TakeSettings(text: string | null): Settings {
  const { quality, camera, zoom, isCalm } = Parse(text) as Partial<Record<keyof Settings, unknown>>;
  const isLevel = Number.isInteger(quality) && Number(quality) >= 0 && Number(quality) < kQualityLevels;
  const isZoom = typeof zoom === 'number' && zoom >= kZoomRange[0] && zoom <= kZoomRange[1];
  const mode = Object.values(CameraMode).find((each) => each === camera);
  return {
    quality: isLevel ? Number(quality) : kDefaults.quality,
    camera: mode ?? kDefaults.camera,
    zoom: isZoom ? zoom : kDefaults.zoom,
    isCalm: typeof isCalm === 'boolean' ? isCalm : kDefaults.isCalm,
  };
}

function Parse(text: string | null): object {
  try {
    const value: unknown = JSON.parse(text ?? '{}');
    return typeof value === 'object' && value !== null ? value : {};
  } catch {
    return {};
  }
}
