// Lines that appear for a few seconds: actions of players, and reasons why a command was refused.
import { MakeElement } from './element';

const kShownFor = 4500; // ms
const kMostShown = 4;

export class Toasts {
  readonly element = MakeElement('div', 'toasts');

  constructor() {
    this.element.setAttribute('role', 'status');
    this.element.setAttribute('aria-live', 'polite');
  }

  // isNotice: for this player only.
  Add(text: string, isNotice = false): void {
    const last = this.element.lastElementChild;
    if (last?.textContent === text) last.remove();
    const toast = MakeElement('div', isNotice ? 'toast notice' : 'toast', text);
    this.element.append(toast);
    while (this.element.childElementCount > kMostShown) this.element.firstElementChild!.remove();
    setTimeout(() => toast.remove(), kShownFor);
  }
}
