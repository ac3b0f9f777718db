// One line that suggests the next action, in words of the device in use; a suggestion that was followed once is not
// shown again.
import { Device } from '../input/device';
import { MakeElement, SetText } from './element';

export interface Hint {
  use: string;
  texts: Record<Device, string>; // empty: none for this device
}

function MakeHint(use: string, desk: string, touch: string, pad: string): Hint {
  return { use, texts: { [Device.Desk]: desk, [Device.Touch]: touch, [Device.Pad]: pad } };
}

const kMove = MakeHint('move', 'Move with W A S D', 'Move with the stick', 'Move with the left stick');
const kJump = MakeHint('jump', 'Jump with the space bar', '', 'Jump with A');
const kLook = MakeHint(
  'look',
  'Drag empty space to look around, wheel to zoom',
  'Drag the world to look around, pinch to zoom',
  'Look around with the right stick',
);
const kPuff = MakeHint('puff', 'Hold E to puff up', '', 'Hold B to puff up');
const kStiffen = MakeHint('stiffen', 'Hold F to stiffen', '', 'Hold X to stiffen');
const kRest = 1.2; // s between two hints
const kLongest = 14; // s after which a hint that is not followed disappears

export class Hints {
  readonly element = MakeElement('div', 'hint');
  private m_queue: Hint[] = [];
  private readonly m_used = new Set<string>();
  private m_current: Hint | null = null;
  private m_device = Device.Desk;
  private m_since = 0;
  private m_next = 0;

  // Starts the hints of a new world. tools: in the order of the tool bar.
  Begin(hasBody: boolean, tools: readonly { name: string; hints: Hint['texts'] }[]): void {
    const own = hasBody ? [kMove, kJump, kLook] : [kLook];
    const rest = hasBody ? [kPuff, kStiffen] : [];
    const hands = tools.map((tool) => ({ use: tool.name, texts: tool.hints }));
    this.m_queue = [...own, ...hands, ...rest].filter((hint) => !this.m_used.has(hint.use));
    this.m_current = null;
    this.m_next = 0;
  }

  // The device that is used from now on.
  Speak(device: Device): void {
    this.m_device = device;
    if (this.m_current !== null) SetText(this.element, this.m_current.texts[device]);
  }

  // Shows the hint of a tool just chosen.
  Say(use: string, texts: Hint['texts'], now: number): void {
    if (this.m_used.has(use)) return;
    this.m_queue = this.m_queue.filter((hint) => hint.use !== use);
    this.Show({ use, texts }, now);
  }

  NoteUse(use: string): void {
    if (this.m_used.has(use)) return;
    this.m_used.add(use);
    this.m_queue = this.m_queue.filter((hint) => hint.use !== use);
  }

  Update(now: number): void {
    if (this.m_current !== null) {
      const isDone = this.m_used.has(this.m_current.use) || now - this.m_since > kLongest;
      if (isDone && now - this.m_since > kRest) {
        this.m_current = null;
        this.m_next = now + kRest;
        this.element.style.opacity = '0';
      }
      return;
    }
    if (now < this.m_next) return;
    const at = this.m_queue.findIndex((hint) => hint.texts[this.m_device] !== '');
    if (at >= 0) this.Show(this.m_queue.splice(at, 1)[0], now);
  }

  private Show(hint: Hint, now: number): void {
    this.m_current = hint;
    this.m_since = now;
    this.element.style.opacity = '1';
    SetText(this.element, hint.texts[this.m_device]);
  }
}
