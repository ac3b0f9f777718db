// A stick on the left and round buttons on the right, for touch.
import { MakeElement } from '../hud/element';
import { Held } from './held';

const kActions = [
  ['jump', 'Jump'],
  ['puff', 'Puff'],
  ['stiffen', 'Stiff'],
] as const;

export class TouchControls {
  readonly stick = MakeElement('div', 'stick');
  readonly buttons = MakeElement('div', 'round');
  // Right and forward, -1 to 1.
  moveX = 0;
  moveY = 0;
  private readonly m_knob = MakeElement('i');
  private readonly m_held = new Held(); // actions
  private m_finger: number | null = null;

  constructor() {
    this.stick.append(this.m_knob);
    this.stick.setAttribute('role', 'img');
    this.stick.setAttribute('aria-label', 'Move');
    this.stick.addEventListener('pointerdown', (event) => this.PressStick(event));
    this.stick.addEventListener('pointermove', (event) => this.MoveStick(event));
    for (const end of ['pointerup', 'pointercancel'] as const) {
      this.stick.addEventListener(end, () => this.ReleaseStick());
    }
    for (const [action, text] of kActions) this.buttons.append(this.MakeRound(action, text));
    this.Show(false, false);
  }

  Read(action: string): number {
    return this.m_held.Has(action) ? 1 : 0;
  }

  // Call when all have read the buttons of a frame.
  EndFrame(): void {
    this.m_held.EndFrame();
  }

  Show(hasStick: boolean, hasButtons: boolean): void {
    if (!hasStick && !this.stick.hidden) this.ReleaseStick();
    this.stick.hidden = !hasStick;
    if (!hasButtons) this.m_held.Clear();
    this.buttons.hidden = !hasButtons;
  }

  private MakeRound(action: string, text: string): HTMLButtonElement {
    const button = MakeElement('button', '', text);
    button.type = 'button';
    button.addEventListener('pointerdown', (event) => {
      button.setPointerCapture(event.pointerId);
      this.m_held.Press(action);
      button.classList.add('held');
      event.preventDefault();
    });
    for (const end of ['pointerup', 'pointercancel'] as const) {
      button.addEventListener(end, () => {
        this.m_held.Release(action);
        button.classList.remove('held');
      });
    }
    return button;
  }

  private PressStick(event: PointerEvent): void {
    this.m_finger = event.pointerId;
    this.stick.setPointerCapture(event.pointerId);
    this.MoveStick(event);
    event.preventDefault();
  }

  private MoveStick(event: PointerEvent): void {
    if (event.pointerId !== this.m_finger) return;
    const box = this.stick.getBoundingClientRect();
    const half = box.width / 2;
    const x = (event.clientX - box.left - half) / half;
    const y = (event.clientY - box.top - half) / half;
    const length = Math.max(1, Math.hypot(x, y));
    this.moveX = x / length;
    this.moveY = -y / length;
    this.m_knob.style.transform = `translate(${this.moveX * half * 0.6}px, ${-this.moveY * half * 0.6}px)`;
  }

  private ReleaseStick(): void {
    this.m_finger = null;
    this.moveX = this.moveY = 0;
    this.m_knob.style.transform = '';
  }
}
