// Thuds of contacts, made by WebAudio: a sine that falls, deeper for larger bodies and higher for faster ones, with a
// little noise at its beginning. Browsers play nothing before the player has touched the page.
import { MakeElement, SetPressed } from '../hud/element';
import type { Client, WorldEvent } from 'wobble-client';
import { EventKind } from 'wobble-client';
import type { Players } from '../players';
import { Keep, ReadKept } from '../storage';
import { ContactFinder, type MovingBody, type Thud } from './contacts';

const kKey = 'wobble.volume';
const kUsual = 0.4; // volume, 0 to 1
const kMostVoices = 8;
const kNear = 8; // m; at this distance a thud is half as loud
const kLoud = 9; // m/s; from this speed on thuds grow no louder
const kFaintest = 0.004; // gain; fainter ones are not played
const kSide = 12; // m to the side at which a thud comes from one side alone

// Where the listener is: a place, and its right as a unit vector in the plane.
export interface Listener {
  x: number;
  y: number;
  z: number;
  rightX: number;
  rightY: number;
}

export class Sound {
  readonly element = MakeElement('div', 'sound');
  readonly played: Thud[] = []; // the newest few, for tests
  private readonly m_button = MakeElement('button', '', 'Sound');
  private readonly m_slider = MakeElement('input');
  private readonly m_finder = new ContactFinder();
  private readonly m_moving: MovingBody[] = [];
  private m_volume = ReadVolume();
  private m_last = kUsual; // volume to go back to
  private m_context: AudioContext | null = null;
  private m_out: GainNode | null = null;
  private m_noise: AudioBuffer | null = null;
  private m_voices = 0;

  constructor() {
    if (this.m_volume > 0) this.m_last = this.m_volume;
    this.m_button.type = 'button';
    this.m_button.title = 'Sound of contacts';
    this.m_button.addEventListener('click', () => this.SetVolume(this.m_volume > 0 ? 0 : this.m_last));
    this.m_slider.type = 'range';
    this.m_slider.min = '0';
    this.m_slider.max = '100';
    this.m_slider.setAttribute('aria-label', 'Volume');
    this.m_slider.addEventListener('input', () => this.SetVolume(Number(this.m_slider.value) / 100));
    this.element.append(this.m_button, this.m_slider);
    for (const gesture of ['pointerdown', 'keydown', 'touchend']) {
      window.addEventListener(gesture, () => this.Wake(), { passive: true });
    }
    this.Show();
  }

  Clear(): void {
    this.m_finder.Clear();
  }

  NoteEvent(event: WorldEvent): void {
    if (event.kind === EventKind.Respawn) this.m_finder.Forget(event.body);
  }

  Update(client: Client, players: Players, listener: Listener, now: number): void {
    if (this.m_volume === 0 || this.m_context === null) return;
    this.m_moving.length = 0;
    for (let i = 0; i < client.bodyCount; ++i) {
      const { body, blueprint, x, y, z, held } = client.bodies[i];
      const size = client.findBlueprint(blueprint).size;
      this.m_moving.push({ body, x, y, z, size, isPlayer: players.IsPlayer(body), isHeld: held });
    }
    const gravity = client.readTuning().gravity.z;
    for (const thud of this.m_finder.Update(this.m_moving, now, gravity)) this.Play(thud, listener);
  }

  // After a gesture, without which browsers let no page sound.
  private Wake(): void {
    if (this.m_volume === 0) return;
    if (this.m_context === null) this.Open();
    if (this.m_context?.state === 'suspended') void this.m_context.resume().catch(() => {});
  }

  private Open(): void {
    if (typeof AudioContext === 'undefined') return;
    const context = new AudioContext();
    this.m_context = context;
    this.m_out = context.createGain();
    this.m_out.gain.value = this.m_volume ** 2;
    this.m_out.connect(context.destination);
    const length = Math.round(0.04 * context.sampleRate);
    this.m_noise = context.createBuffer(1, length, context.sampleRate);
    const samples = this.m_noise.getChannelData(0);
    for (let i = 0; i < length; ++i) samples[i] = (2 * Math.random() - 1) * (1 - i / length) ** 2;
  }

  private Play(thud: Thud, listener: Listener): void {
    const context = this.m_context;
    if (context === null || this.m_out === null || this.m_voices >= kMostVoices) return;
    const [x, y, z] = [thud.x - listener.x, thud.y - listener.y, thud.z - listener.z];
    const far = 1 / (1 + (Math.hypot(x, y, z) / kNear) ** 2);
    const force = Math.min(1, thud.speed / kLoud);
    const loud = 0.9 * force ** 1.5 * far;
    if (loud < kFaintest) return;
    this.played.push(thud);
    if (this.played.length > 32) this.played.shift();
    const begin = context.currentTime;
    const pitch = Math.max(45, Math.min(420, (95 / Math.max(0.15, thud.size)) * (0.8 + 0.5 * force)));
    const length = 0.12 + 0.1 * Math.min(2, thud.size);
    const pan = context.createStereoPanner();
    pan.pan.value = Math.max(-0.9, Math.min(0.9, (x * listener.rightX + y * listener.rightY) / kSide));
    pan.connect(this.m_out);
    const gain = context.createGain();
    gain.gain.setValueAtTime(0.0001, begin);
    gain.gain.exponentialRampToValueAtTime(loud, begin + 0.008);
    gain.gain.exponentialRampToValueAtTime(0.0001, begin + length);
    gain.connect(pan);
    const tone = context.createOscillator();
    tone.frequency.setValueAtTime(1.6 * pitch, begin);
    tone.frequency.exponentialRampToValueAtTime(0.7 * pitch, begin + length);
    tone.connect(gain);
    const noise = context.createBufferSource();
    noise.buffer = this.m_noise;
    const filter = context.createBiquadFilter();
    filter.frequency.value = 5 * pitch;
    noise.connect(filter).connect(gain);
    this.m_voices += 1;
    tone.onended = () => {
      this.m_voices -= 1;
      pan.disconnect();
    };
    noise.start(begin);
    tone.start(begin);
    tone.stop(begin + length);
  }

  private SetVolume(volume: number): void {
    this.m_volume = volume;
    if (volume > 0) this.m_last = volume;
    Keep(kKey, String(volume));
    this.Wake();
    if (this.m_out !== null) this.m_out.gain.value = volume ** 2;
    if (volume === 0) this.m_finder.Clear();
    this.Show();
  }

  private Show(): void {
    SetPressed(this.m_button, this.m_volume > 0);
    this.m_slider.hidden = this.m_volume === 0;
    const value = String(Math.round(100 * this.m_volume));
    if (this.m_slider.value !== value) this.m_slider.value = value;
  }
}

function ReadVolume(): number {
  const kept = ReadKept(kKey);
  const volume = kept === null ? kUsual : Number(kept);
  return volume >= 0 && volume <= 1 ? volume : kUsual;
}
