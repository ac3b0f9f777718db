// Less is drawn where frames take too long, and more again where there is time to spare: as many steps down as it
// takes, each step up tried once, or it would go to and fro.

export interface QualityLevel {
  maxPixelRatio: number;
  pixelShare: number; // of that ratio
  shadowSize: number; // texels; 0: no shadows
  shadowEvery: number; // frames
  isRich: boolean; // smooth surfaces show the sky, and the sky has clouds
}

const kLevels: QualityLevel[] = [
  { maxPixelRatio: 2, pixelShare: 1, shadowSize: 2048, shadowEvery: 1, isRich: true },
  { maxPixelRatio: 1.5, pixelShare: 1, shadowSize: 1024, shadowEvery: 1, isRich: true },
  { maxPixelRatio: 1, pixelShare: 1, shadowSize: 1024, shadowEvery: 2, isRich: true },
  { maxPixelRatio: 1, pixelShare: 0.75, shadowSize: 512, shadowEvery: 2, isRich: false },
  { maxPixelRatio: 1, pixelShare: 0.5, shadowSize: 512, shadowEvery: 3, isRich: false },
  { maxPixelRatio: 1, pixelShare: 0.4, shadowSize: 0, shadowEvery: 1, isRich: false },
];
const kSoftwareLevel = 3; // to begin with where no graphics card draws
const kSlowFrame = 0.033; // s
const kFastFrame = 0.012;
const kSlowFor = 1.5; // s until a step down
const kFastFor = 8; // s until a step up
const kLongestFrame = 0.25; // s; a longer one is a page that was hidden

export class Quality {
  private m_level: number;
  private readonly m_isFixed: boolean;
  private readonly m_apply: (level: QualityLevel) => void;
  private m_slowSince = 0;
  private m_fastSince = 0;
  private m_mean = 0.016;
  private m_tooMuch: number; // the highest level that was too much; -1: none

  // fixed: a level that is kept; null: as frames allow.
  constructor(fixed: number | null, isSoftware: boolean, apply: (level: QualityLevel) => void) {
    this.m_isFixed = fixed !== null;
    this.m_level = Math.min(fixed ?? (isSoftware ? kSoftwareLevel : 0), kLevels.length - 1);
    this.m_tooMuch = isSoftware ? this.m_level : -1;
    this.m_apply = apply;
    apply(kLevels[this.m_level]);
  }

  get level(): number {
    return this.m_level;
  }

  // Mean time between frames lately, s.
  get frameTime(): number {
    return this.m_mean;
  }

  NoteFrame(now: number, seconds: number): void {
    if (seconds > kLongestFrame) {
      this.m_slowSince = this.m_fastSince = now;
      // A machine so slow that every frame is this long must not be taken for a hidden page for ever.
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
