// The worlds to choose from, and the purpose of the chosen one.
import { FindPurpose } from '../worlds';
import { MakeButton, MakeElement, SetPressed, SetText } from './element';

export class WorldMenu {
  readonly element = MakeElement('nav', 'worlds');
  onChoose: (world: string) => void = () => {};
  private readonly m_buttons = new Map<string, HTMLButtonElement>();
  private readonly m_purpose = MakeElement('p', 'note');

  constructor() {
    this.element.setAttribute('aria-label', 'Worlds');
    this.element.hidden = true;
  }

  // Hidden when there is only one world.
  List(worlds: readonly string[]): void {
    for (const world of worlds) {
      const button = MakeButton(world, `Play ${world}`, '', () => this.onChoose(world));
      this.m_buttons.set(world, button);
      this.element.append(button);
    }
    this.element.append(this.m_purpose);
    this.element.hidden = worlds.length < 2;
  }

  Show(world: string): void {
    for (const [name, button] of this.m_buttons) SetPressed(button, name === world);
    SetText(this.m_purpose, FindPurpose(world));
  }
}
