// One line that suggests the next action; a suggestion that was followed once is not shown again.
import { MakeElement, SetText } from './element';

interface Hint {
  use: string;
  text: string;
}

const kMove: Hint = { use: 'move', text: 'Move with W A S D' };
const kJump: Hint = { use: 'jump', text: 'Jump with the space bar' };
const kLook: Hint = { use: 'look', text: 'Drag empty space to look around, wheel to zoom' };
const kPuff: Hint = { use: 'puff', text: 'Hold E to puff up' };
const kStiffen: Hint = { use: 'stiffen', text: 'Hold F to stiffen' };
const kTouchMove: Hint = { use: 'look', text: 'Stick to move, drag the world to look, pinch to zoom' };
const kRest = 1.2; // s between two hints
const kLongest = 14; // s after which a hint that is not followed disappears

export class Hints {
  readonly element = MakeElement('div', 'hint');
  private m_queue: Hint[] = [];
  private readonly m_used = new Set<string>();
  private m_current: Hint | null = null;
  private m_since = 0;
  private m_next = 0;

  // Starts the hints of a new world. tools: in the order of the tool bar.
  Begin(hasBody: boolean, tools: readonly { name: string; hint: string }[]): void {
    const isTouch = window.matchMedia('(pointer: coarse)').matches;
    const own = !hasBody ? [kLook] : isTouch ? [kTouchMove] : [kMove, kJump, kLook];
    const rest = hasBody && !isTouch ? [kPuff, kStiffen] : [];
    const hands = tools.map((tool) => ({ use: tool.name, text: tool.hint }));
    this.m_queue = [...own, ...hands, ...rest].filter((hint) => !this.m_used.has(hint.use));
    this.m_current = null;
    this.m_next = 0;
  }

  // Shows the hint of a tool just chosen.
  Say(use: string, text: string, now: number): void {
    if (this.m_used.has(use)) return;
    this.m_queue = this.m_queue.filter((hint) => hint.use !== use);
    this.Show({ use, text }, now);
  }

  NoteUse(use: string): void {
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
    const hint = this.m_queue.shift();
    if (hint !== undefined) this.Show(hint, now);
  }

  private Show(hint: Hint, now: number): void {
    this.m_current = hint;
    this.m_since = now;
    this.element.style.opacity = '1';
    SetText(this.element, hint.text);
  }
}
