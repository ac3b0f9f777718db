// The tool bar and the active tool, which gets the pointer's presses. A click with any tool also selects the body of
// the view panel.
import { MakeElement, SetPressed, ShowKey } from '../hud/element';
import { Device } from '../input/device';
import type { Place, PointerTaker } from '../input/pointer';
import type { Bench, Tool } from './tool';

const kSvg = 'http://www.w3.org/2000/svg';

export class HandTools implements PointerTaker {
  readonly element = MakeElement('div', 'panel tools');
  onUse: (what: string) => void = () => {};
  onClick: (body: number) => void = () => {};
  onChoose: (tool: Tool | null) => void = () => {};
  active: Tool | null = null;

  private readonly m_bench: Bench;
  private readonly m_tools: Tool[];
  private m_allowed: Tool[] = [];
  private m_device = Device.Desk;
  private readonly m_buttons = new Map<Tool, HTMLButtonElement>();

  constructor(bench: Bench, tools: Tool[]) {
    this.m_bench = bench;
    this.m_tools = tools;
    this.element.setAttribute('role', 'toolbar');
    this.element.setAttribute('aria-label', 'Tools');
    this.element.hidden = true;
  }

  // hands: bits of Welcome.hands.
  Allow(hands: number): void {
    this.active?.Drop();
    this.m_allowed = this.m_tools.filter((tool) => (tool.hand & hands) !== 0);
    this.m_buttons.clear();
    this.element.replaceChildren();
    this.m_allowed.forEach((tool, index) => {
      const button = MakeToolButton(tool, index + 1, () => this.Choose(index));
      this.m_buttons.set(tool, button);
      this.element.append(button);
    });
    this.Speak(this.m_device);
    this.element.hidden = this.m_allowed.length === 0;
    const kept = this.active !== null && this.m_allowed.includes(this.active) ? this.active : this.m_allowed[0];
    this.Activate(kept ?? null);
  }

  Allowed(): readonly Tool[] {
    return this.m_allowed;
  }

  // index: from 0, as on the number keys; ignored where there is no such tool.
  Choose(index: number): void {
    const tool = this.m_allowed[index];
    if (tool !== undefined) this.Activate(tool);
  }

  // step: 1 to the next tool, -1 to the one before.
  ChooseNext(step: number): void {
    const count = this.m_allowed.length;
    if (count === 0) return;
    const at = this.active === null ? -1 : this.m_allowed.indexOf(this.active);
    this.Choose((at + step + count) % count);
  }

  // The device that is used from now on.
  Speak(device: Device): void {
    this.m_device = device;
    for (const [tool, button] of this.m_buttons) {
      button.title = tool.hints[device];
      button.setAttribute('aria-label', `${tool.name}: ${tool.hints[device]}`);
    }
  }

  Update(): void {
    this.active?.Update();
  }

  Begin(place: Place): boolean {
    this.NoteClick(place);
    const isTaken = this.active?.Begin(place) ?? false;
    if (isTaken) this.onUse(this.active!.name);
    return isTaken;
  }

  Move(place: Place): void {
    this.active?.Move(place);
  }

  End(place: Place): void {
    this.active?.End(place);
  }

  Wheel(notches: number): boolean {
    return this.active?.Wheel(notches) ?? false;
  }

  private Activate(tool: Tool | null): void {
    if (this.active !== tool) this.active?.Drop();
    this.active = tool;
    for (const [each, button] of this.m_buttons) SetPressed(button, each === tool);
    this.onChoose(tool);
  }

  private NoteClick(place: Place): void {
    const client = this.m_bench.FindClient();
    if (client === null) return;
    this.m_bench.picking.AimAt(place.x, place.y);
    const pick = this.m_bench.picking.FindBody(client);
    if (pick !== null) this.onClick(pick.body);
  }
}

function MakeToolButton(tool: Tool, key: number, onClick: () => void): HTMLButtonElement {
  const button = MakeElement('button');
  button.type = 'button';
  const drawing = document.createElementNS(kSvg, 'svg');
  drawing.setAttribute('viewBox', '0 0 24 24');
  drawing.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(kSvg, 'path');
  for (const [name, value] of [
    ['d', tool.icon],
    ['fill', 'none'],
    ['stroke', 'currentColor'],
    ['stroke-width', '1.8'],
    ['stroke-linecap', 'round'],
    ['stroke-linejoin', 'round'],
  ]) {
    path.setAttribute(name, value);
  }
  drawing.append(path);
  const text = MakeElement('span', '', tool.name);
  ShowKey(button, String(key));
  button.append(drawing, text);
  button.addEventListener('click', () => {
    onClick();
    if (!button.matches(':focus-visible')) button.blur();
  });
  return button;
}
