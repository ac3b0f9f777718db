// A part of the page that short and narrow screens fold behind a button. Where there is room it is always open and has
// no button; the style sheet says which screens have room.
import { MakeElement } from './element';

export class Drawer {
  readonly element: HTMLElement;
  private readonly m_button = MakeElement('button', 'drawer-button');
  private readonly m_text = MakeElement('span');
  private readonly m_label: string;

  // name: of its class. label: for screen readers, behind the text.
  constructor(name: string, label: string, text: string, content: HTMLElement) {
    this.element = MakeElement('div', `drawer ${name}`);
    this.m_label = label;
    content.id = `drawer-${name}`;
    content.classList.add('drawer-content');
    this.m_button.type = 'button';
    this.m_button.setAttribute('aria-controls', content.id);
    this.m_button.append(this.m_text);
    this.m_button.addEventListener('click', () => this.Open(!this.isOpen));
    this.SetText(text);
    this.element.append(this.m_button, content);
    this.Open(false);
    // The world behind it is pressed to go on playing.
    document.querySelector('#world')!.addEventListener('pointerdown', () => this.Open(false));
  }

  get isOpen(): boolean {
    return this.element.classList.contains('open');
  }

  Open(isOpen: boolean): void {
    this.element.classList.toggle('open', isOpen);
    this.m_button.setAttribute('aria-expanded', String(isOpen));
  }

  SetText(text: string): void {
    if (this.m_text.textContent === text) return;
    this.m_text.textContent = text;
    this.m_button.setAttribute('aria-label', `${text}: ${this.m_label}`);
  }
}
