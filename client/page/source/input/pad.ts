// A gamepad, by the Gamepad API. Browsers have it for pages of https and localhost alone, and show a gamepad from its
// first press on.
import type { Command } from './keys';

const kDeadZone = 0.18; // share of a stick's way that is taken for rest
const kHalfPressed = 0.5; // of a trigger

// Buttons as the standard mapping numbers them.
enum Button {
  A = 0,
  B = 1,
  X = 2,
  Y = 3,
  LeftBumper = 4,
  RightBumper = 5,
  RightTrigger = 7,
  Back = 8,
  Start = 9,
  Up = 12,
  Down = 13,
}

const kHeld: Record<string, Button> = {
  jump: Button.A,
  puff: Button.B,
  stiffen: Button.X,
  use: Button.RightTrigger,
  nearer: Button.Up,
  farther: Button.Down,
};
const kCommands = new Map<Button, Command>([
  [Button.Y, 'camera'],
  [Button.LeftBumper, { toolStep: -1 }],
  [Button.RightBumper, { toolStep: 1 }],
  [Button.Back, 'view'],
  [Button.Start, 'help'],
]);

// Whether the browser has gamepads for this page.
export function HasPads(): boolean {
  return window.isSecureContext && typeof navigator.getGamepads === 'function';
}

export class Pad {
  // Right and forward, right and down: -1 to 1.
  moveX = 0;
  moveY = 0;
  lookX = 0;
  lookY = 0;
  isUsed = false; // in this frame
  onCommand: (command: Command) => void = () => {};
  private m_pressed: boolean[] = [];
  private m_isBlocked = false;

  // Call once a frame. isInDialog: a dialog is open, which B closes; nothing else acts.
  Update(isInDialog: boolean): void {
    const pad = FindPad();
    const before = this.m_pressed;
    this.m_isBlocked = isInDialog;
    this.m_pressed = pad === null ? [] : pad.buttons.map((button) => button.pressed || button.value > kHalfPressed);
    const [moveX, moveY] = ReadStick(pad, 0);
    const [lookX, lookY] = ReadStick(pad, 2);
    this.isUsed = this.m_pressed.includes(true) || [moveX, moveY, lookX, lookY].some((each) => each !== 0);
    this.moveX = isInDialog ? 0 : moveX;
    this.moveY = isInDialog ? 0 : -moveY;
    this.lookX = isInDialog ? 0 : lookX;
    this.lookY = isInDialog ? 0 : lookY;
    const isNew = (button: Button) => this.m_pressed[button] === true && before[button] !== true;
    if (isInDialog) {
      if (isNew(Button.B) || isNew(Button.Start)) this.onCommand('escape');
      return;
    }
    for (const [button, command] of kCommands) if (isNew(button)) this.onCommand(command);
  }

  // 1 while the button of the action is held, else 0.
  Read(action: string): number {
    return !this.m_isBlocked && this.m_pressed[kHeld[action]] === true ? 1 : 0;
  }
}

// The first that is connected and has a stick.
function FindPad(): Gamepad | null {
  if (!HasPads()) return null;
  return navigator.getGamepads().find((pad) => pad?.connected === true && pad.axes.length >= 2) ?? null;
}

// The way begins at 0 beyond the dead zone, so that slow motion is possible.
function ReadStick(pad: Gamepad | null, axis: number): [number, number] {
  const x = pad?.axes[axis] ?? 0;
  const y = pad?.axes[axis + 1] ?? 0;
  const length = Math.hypot(x, y);
  if (!(length > kDeadZone)) return [0, 0];
  const share = Math.min(1, (length - kDeadZone) / (1 - kDeadZone)) / length;
  return [x * share, y * share];
}
