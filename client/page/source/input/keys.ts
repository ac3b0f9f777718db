// The keyboard: held keys act as long as they are held, all others once.
import { Held } from './held';

export type Command =
  | 'camera'
  | 'view'
  | 'world'
  | 'settings'
  | 'fullscreen'
  | 'help'
  | 'surface'
  | 'escape'
  | 'remove'
  | 'say'
  | 'emote'
  | { tool: number }
  | { toolStep: number };

const kHeld: Record<string, string> = {
  KeyW: 'forward',
  ArrowUp: 'forward',
  KeyS: 'back',
  ArrowDown: 'back',
  KeyA: 'left',
  ArrowLeft: 'left',
  KeyD: 'right',
  ArrowRight: 'right',
  Space: 'jump',
  KeyE: 'puff',
  KeyP: 'puff',
  KeyF: 'stiffen',
  Comma: 'lookLeft',
  Period: 'lookRight',
  PageUp: 'nearer',
  PageDown: 'farther',
  KeyU: 'use',
};
const kCommands: Record<string, Command> = {
  KeyC: 'camera',
  KeyV: 'view',
  KeyG: 'world',
  KeyH: 'help',
  KeyX: 'surface',
  Escape: 'escape',
  Delete: 'remove',
  Backspace: 'remove',
  Digit1: { tool: 0 },
  Digit2: { tool: 1 },
  Digit3: { tool: 2 },
  Digit4: { tool: 3 },
  Digit5: { tool: 4 },
  Digit6: { tool: 5 },
  KeyT: 'say',
  Enter: 'say',
  KeyQ: 'emote',
};

export class Keys {
  onCommand: (command: Command) => void = () => {};
  // Called with the name of the action that was used, for the hints.
  onUse: (what: string) => void = () => {};
  private readonly m_held = new Held(); // codes

  constructor() {
    window.addEventListener('keydown', (event) => this.Press(event));
    window.addEventListener('keyup', (event) => this.m_held.Release(event.code));
    window.addEventListener('blur', () => this.m_held.Clear());
  }

  // 1 while a key of the action is held, else 0.
  Read(action: string): number {
    return Object.keys(kHeld).some((code) => kHeld[code] === action && this.m_held.Has(code)) ? 1 : 0;
  }

  // Call when all have read the keys of a frame.
  EndFrame(): void {
    this.m_held.EndFrame();
  }

  private Press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || IsWriting(event.target)) return;
    const isPress = event.code === 'Space' || event.code === 'Enter';
    if (isPress && IsPressable(event.target)) return;
    const action = kHeld[event.code];
    const isSlider = IsChooser(event.target) && event.code.startsWith('Arrow');
    if (action !== undefined && !isSlider) {
      event.preventDefault();
      this.m_held.Press(event.code);
      this.onUse(FindUse(action));
      return;
    }
    const command = event.key === '?' ? 'help' : kCommands[event.code];
    if (command === undefined || event.repeat) return;
    if (command === 'say') event.preventDefault(); // the key is not for the field that opens
    this.onCommand(command);
  }
}

// As hints name it.
function FindUse(action: string): string {
  if (['forward', 'back', 'left', 'right'].includes(action)) return 'move';
  return action.startsWith('look') ? 'look' : action;
}

export function IsWriting(target: EventTarget | null): boolean {
  return target instanceof HTMLInputElement && target.type !== 'range' && target.type !== 'checkbox';
}

// What the space bar and Enter press.
function IsPressable(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest('button, summary, select, a, input') !== null;
}

// What the arrow keys change.
function IsChooser(target: EventTarget | null): boolean {
  return target instanceof HTMLInputElement || target instanceof HTMLSelectElement;
}
