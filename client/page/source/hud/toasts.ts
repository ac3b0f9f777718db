// Lines that come and go: who did what, and why something was not done.
import { MakeElement } from './element';

const kShownFor = 4500; // ms
const kMostShown = 4;

export class Toasts {
  readonly element = MakeElement('div', 'toasts');

  constructor() {
    this.element.setAttribute('role', 'status');
    this.element.setAttribute('aria-live', 'polite');
  }

  // isNotice: it is for this player alone.
  Add(text: string, isNotice = false): void {
    const last = this.element.lastElementChild;
    if (last?.textContent === text) last.remove();
    const toast = MakeElement('div', isNotice ? 'toast notice' : 'toast', text);
    this.element.append(toast);
    while (this.element.childElementCount > kMostShown) this.element.firstElementChild!.remove();
    setTimeout(() => toast.remove(), kShownFor);
  }
}
