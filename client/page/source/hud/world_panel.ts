// The parameters of the world that all players share: direction of gravity, stiffness of springs, rate of time. Shows
// those that the scene lets this player change.
import { MayTune, readNow, TuneKind, type Client, type Tuning, type Vector } from 'wobble-client';
import { MakeButton, MakeElement, MakeLogarithmicScale, MakeSlider, SetText, type Slider } from './element';

const kMostTilt = (50 * Math.PI) / 180; // rad
const kStandardGravity = 9.81; // m/s²
const kSendEvery = 0.12; // s
const kReadEvery = 0.1;
const kStiffnessStep = 1.25;
const kLeastStiffness = 0.1;
const kMostStiffness = 10;

export class WorldPanel {
  readonly element = MakeElement('section', 'panel rows');
  private readonly m_gravity = MakeElement('div');
  private readonly m_stiffness = MakeElement('div', 'rows');
  private readonly m_time = MakeElement('div', 'rows');
  private readonly m_pad = MakeElement('div', 'pad');
  private readonly m_knob = MakeElement('i');
  private readonly m_stiffnessShown = MakeElement('output');
  private readonly m_rate: Slider;
  private readonly m_strength: Slider;
  private m_findClient: () => Client | null;
  private m_tuning: Tuning = { gravity: { x: 0, y: 0, z: -kStandardGravity }, stiffness: 1, timeRate: 1, may: 0 };
  private m_wanted: { kind: TuneKind; value: Vector } | null = null; // the latest change of a drag, not sent yet
  private m_nextSend = 0;
  private m_nextRead = 0;
  private m_isHeld = false;
  private m_yaw = 0; // rad; of the camera, so that up on the pad is forward

  constructor(findClient: () => Client | null) {
    this.m_findClient = findClient;
    this.element.setAttribute('aria-label', 'World');
    this.element.hidden = true;
    this.m_strength = MakeSlider(
      'gravity',
      (share) => 2 * kStandardGravity * share,
      (value) => value / (2 * kStandardGravity),
      (value) => `${value.toFixed(1)} m/s²`,
      (value) => this.TuneGravity(this.FindTilt(), value),
    );
    const scale = MakeLogarithmicScale(0.1, 1);
    this.m_rate = MakeSlider(
      'slow motion',
      scale.toValue,
      scale.toShare,
      (value) => `× ${value.toFixed(2)}`,
      (value) => this.Want(TuneKind.TimeRate, { x: value, y: 0, z: 0 }),
    );
    this.BuildGravity();
    this.BuildStiffness();
    this.BuildTime();
    this.element.append(MakeElement('h2', '', 'World, for all players'), this.m_gravity, this.m_stiffness, this.m_time);
  }

  get may(): number {
    return this.m_tuning.may;
  }

  // Call once a frame.
  Update(yaw: number): void {
    const client = this.m_findClient();
    if (client === null) return;
    this.m_yaw = yaw;
    this.Flush(client);
    const now = readNow();
    if (now < this.m_nextRead) return;
    this.m_nextRead = now + kReadEvery;
    this.m_tuning = client.readTuning();
    if (this.element.hidden) return;
    const { may, gravity, stiffness, timeRate } = this.m_tuning;
    this.m_gravity.hidden = (may & MayTune.Gravity) === 0;
    this.m_stiffness.hidden = (may & MayTune.Stiffness) === 0;
    this.m_time.hidden = (may & MayTune.Time) === 0;
    this.m_strength.Set(Math.hypot(gravity.x, gravity.y, gravity.z));
    this.m_rate.Set(timeRate);
    SetText(this.m_stiffnessShown, `× ${stiffness.toFixed(2)}`);
    if (!this.m_isHeld) this.PlaceKnob(this.FindTilt());
  }

  private BuildGravity(): void {
    this.m_pad.append(this.m_knob);
    this.m_pad.tabIndex = 0;
    this.m_pad.setAttribute('role', 'application');
    this.m_pad.setAttribute('aria-label', 'Tilt of gravity: drag, or the arrow keys');
    this.m_pad.addEventListener('pointerdown', (event) => {
      this.m_isHeld = true;
      this.m_pad.setPointerCapture(event.pointerId);
      this.DragPad(event);
    });
    this.m_pad.addEventListener('pointermove', (event) => this.m_isHeld && this.DragPad(event));
    for (const end of ['pointerup', 'pointercancel'] as const) {
      this.m_pad.addEventListener(end, () => (this.m_isHeld = false));
    }
    this.m_pad.addEventListener('keydown', (event) => this.TiltByKey(event));
    const level = MakeButton('Level', 'Level: gravity straight down', '', () =>
      this.TuneGravity({ x: 0, y: 0 }, kStandardGravity),
    );
    const row = MakeElement('div', 'row');
    row.append(level);
    this.m_gravity.append(MakeElement('div', 'note', 'tilt of gravity'), this.m_pad, this.m_strength.element, row);
  }

  private BuildStiffness(): void {
    const less = MakeButton('softer −', 'Softer springs', '', () => this.TuneStiffness(1 / kStiffnessStep));
    const more = MakeButton('stiffer +', 'Stiffer springs', '', () => this.TuneStiffness(kStiffnessStep));
    const line = MakeElement('div', 'field');
    const text = MakeElement('span', '', 'stiffness');
    text.append(this.m_stiffnessShown);
    line.append(text);
    const row = MakeElement('div', 'row');
    row.append(less, more);
    this.m_stiffness.append(line, row);
  }

  private BuildTime(): void {
    const jump = (seconds: number) =>
      MakeButton(`+${seconds} s`, `Jump ${seconds} s ahead in time`, '', () =>
        this.m_findClient()?.tune(TuneKind.Jump, { x: seconds, y: 0, z: 0 }),
      );
    const row = MakeElement('div', 'row');
    row.append(MakeElement('span', 'note', 'jump'), jump(1), jump(5));
    this.m_time.append(this.m_rate.element, row);
  }

  private DragPad(event: PointerEvent): void {
    const box = this.m_pad.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    const length = Math.max(1, Math.hypot(x, y));
    const tilt = { x: x / length, y: y / length };
    this.PlaceKnob(tilt);
    this.TuneGravity(tilt, this.FindStrength());
  }

  private TiltByKey(event: KeyboardEvent): void {
    const ways: Record<string, [number, number]> = {
      ArrowLeft: [-0.1, 0],
      ArrowRight: [0.1, 0],
      ArrowUp: [0, 0.1],
      ArrowDown: [0, -0.1],
    };
    const way = ways[event.key];
    if (way === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const tilt = this.FindTilt();
    this.TuneGravity({ x: tilt.x + way[0], y: tilt.y + way[1] }, this.FindStrength());
  }

  private PlaceKnob(tilt: { x: number; y: number }): void {
    this.m_knob.style.left = `${(50 + 38 * tilt.x).toFixed(1)}%`;
    this.m_knob.style.top = `${(50 - 38 * tilt.y).toFixed(1)}%`;
  }

  private FindStrength(): number {
    const { x, y, z } = this.m_tuning.gravity;
    return Math.hypot(x, y, z) || kStandardGravity;
  }

  // The tilt on the pad, -1 to 1: right, and away from the player.
  private FindTilt(): { x: number; y: number } {
    const { x, y, z } = this.m_tuning.gravity;
    const flat = Math.hypot(x, y);
    if (flat < 1e-6) return { x: 0, y: 0 };
    const share = Math.atan2(flat, -z) / kMostTilt / flat;
    const c = Math.cos(this.m_yaw);
    const s = Math.sin(this.m_yaw);
    return { x: share * (x * s - y * c), y: share * (x * c + y * s) };
  }

  private TuneGravity(tilt: { x: number; y: number }, strength: number): void {
    const size = Math.hypot(tilt.x, tilt.y);
    const angle = Math.min(1, size) * kMostTilt;
    const share = size > 1e-6 ? (strength * Math.sin(angle)) / size : 0;
    const c = Math.cos(this.m_yaw);
    const s = Math.sin(this.m_yaw);
    const x = share * (tilt.x * s + tilt.y * c);
    const y = share * (-tilt.x * c + tilt.y * s);
    this.Want(TuneKind.Gravity, { x, y, z: -strength * Math.cos(angle) });
  }

  private TuneStiffness(factor: number): void {
    const value = Math.max(kLeastStiffness, Math.min(kMostStiffness, this.m_tuning.stiffness * factor));
    this.m_findClient()?.tune(TuneKind.Stiffness, { x: value, y: 0, z: 0 });
  }

  private Want(kind: TuneKind, value: Vector): void {
    this.m_wanted = { kind, value };
  }

  private Flush(client: Client): void {
    const now = readNow();
    if (this.m_wanted === null || now < this.m_nextSend) return;
    this.m_nextSend = now + kSendEvery;
    client.tune(this.m_wanted.kind, this.m_wanted.value);
    this.m_wanted = null;
  }
}
