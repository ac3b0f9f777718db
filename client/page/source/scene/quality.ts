// Lowers the drawing quality when frames take too long and raises it when there is time to spare. It takes as many
// steps down as needed and tries each step up only once; otherwise it would oscillate.

export interface QualityLevel {
  maxPixelRatio: number;
  pixelShare: number; // of the device's pixel ratio
  shadowSize: number; // texels; 0: no shadows
  shadowEvery: number; // frames between updates of the shadows
  isRich: boolean; // smooth surfaces reflect the sky, and the sky has clouds
}

const kLevels: QualityLevel[] = [
  { maxPixelRatio: 2, pixelShare: 1, shadowSize: 2048, shadowEvery: 1, isRich: true },
  { maxPixelRatio: 1.5, pixelShare: 1, shadowSize: 1024, shadowEvery: 1, isRich: true },
  { maxPixelRatio: 1, pixelShare: 1, shadowSize: 1024, shadowEvery: 2, isRich: true },
  { maxPixelRatio: 1, pixelShare: 0.75, shadowSize: 512, shadowEvery: 2, isRich: false },
  { maxPixelRatio: 1, pixelShare: 0.5, shadowSize: 512, shadowEvery: 3, isRich: false },
  { maxPixelRatio: 1, pixelShare: 0.4, shadowSize: 0, shadowEvery: 1, isRich: false },
];
export const kQualityLevels = kLevels.length;
const kSoftwareLevel = 3; // start level without a graphics card; those before it have smooth edges
const kSlowFrame = 0.033; // s
const kFastFrame = 0.012;
const kSlowFor = 1.5; // s before a step down
const kFastFor = 8; // s before a step up
const kLongestFrame = 0.25; // s; a longer frame means that the page was hidden

// Whether edges are anti-aliased, which holds for the life of the page: software takes 80 ms of processor for a frame of
// level 4 with it and 59 without. fixed: as for Quality.
export function HasSmoothEdges(fixed: number | null, isSoftware: boolean): boolean {
  return fixed === null ? !isSoftware : !(fixed >= kSoftwareLevel);
}

export class Quality {
  private m_level: number;
  private m_isFixed = false;
  private readonly m_apply: (level: QualityLevel) => void;
  private m_slowSince = 0;
  private m_fastSince = 0;
  private m_mean = 0.016;
  private m_tooMuch: number; // the highest level that proved too slow; -1: none

  // fixed: a constant level; null: adapt to the frame time.
  constructor(fixed: number | null, isSoftware: boolean, apply: (level: QualityLevel) => void) {
    this.m_isFixed = fixed !== null;
    this.m_level = isSoftware ? kSoftwareLevel : 0;
    if (fixed !== null) this.m_level = Math.max(0, Math.min(kLevels.length - 1, Math.floor(fixed) || 0));
    this.m_tooMuch = isSoftware ? this.m_level : -1;
    this.m_apply = apply;
    apply(kLevels[this.m_level]);
  }

  // A constant level from now on; null: adapt, from the present level on.
  Fix(level: number | null): void {
    this.m_isFixed = level !== null;
    if (level === null || level === this.m_level) return;
    this.m_level = level;
    this.m_apply(kLevels[level]);
  }

  get level(): number {
    return this.m_level;
  }

  // Mean frame time, s.
  get frameTime(): number {
    return this.m_mean;
  }

  NoteFrame(now: number, seconds: number): void {
    if (seconds > kLongestFrame) {
      this.m_slowSince = this.m_fastSince = now;
      // Without this a machine on which every frame takes so long would always count as a hidden page.
      this.m_mean = 0.9 * this.m_mean + 0.1 * kLongestFrame;
      if (this.m_mean > 0.1) this.StepDown(now);
      return;
    }
    this.m_mean += 0.08 * (seconds - this.m_mean);
    if (this.m_mean < kSlowFrame) this.m_slowSince = now;
    if (this.m_mean > kFastFrame) this.m_fastSince = now;
    if (now - this.m_slowSince > kSlowFor) this.StepDown(now);
    if (now - this.m_fastSince > kFastFor) this.StepUp(now);
  }

  private StepDown(now: number): void {
    if (this.m_isFixed || this.m_level === kLevels.length - 1) return;
    this.m_tooMuch = Math.max(this.m_tooMuch, this.m_level);
    this.Change(this.m_level + 1, now);
  }

  private StepUp(now: number): void {
    if (this.m_isFixed || this.m_level === 0 || this.m_level - 1 <= this.m_tooMuch) return;
    this.Change(this.m_level - 1, now);
  }

  private Change(level: number, now: number): void {
    this.m_level = level;
    this.m_slowSince = this.m_fastSince = now;
    this.m_mean = (kSlowFrame + kFastFrame) / 2;
    this.m_apply(kLevels[level]);
  }
}
