// The list of all keys, above the world until it is closed.
import { MakeButton, MakeElement } from './element';

const kKeys: [string, string][] = [
  ['W A S D, arrows', 'move in the direction of view'],
  ['Space', 'jump'],
  ['E or P', 'puff up'],
  ['F', 'stiffen'],
  ['1 2 3 4', 'choose a tool'],
  ['left button', 'use the tool on a body; elsewhere: look around'],
  ['right button', 'look around'],
  ['wheel', 'zoom; while grabbing: nearer or farther'],
  ['C', 'camera: follow, circle, free'],
  ['V', 'view: forces, accelerations, springs'],
  ['X', 'surfaces on and off'],
  ['G', 'world: gravity, stiffness, time (if the scene allows it)'],
  ['T or Enter', 'say a line to all'],
  ['Q', 'show an emote: then 1 to 6'],
  ['H or ?', 'show this list'],
];

export class Help {
  readonly element = MakeElement('div', 'veil');

  constructor() {
    const card = MakeElement('div', 'card');
    card.setAttribute('role', 'dialog');
    card.setAttribute('aria-label', 'Keys');
    const list = MakeElement('dl', 'keys');
    for (const [keys, text] of kKeys) {
      const term = MakeElement('dt');
      term.append(MakeElement('kbd', '', keys));
      list.append(term, MakeElement('dd', '', text));
    }
    const close = MakeButton('Continue', 'Close', '', () => this.Toggle());
    close.classList.add('main');
    card.append(MakeElement('h1', '', 'Keys'), list, close);
    this.element.append(card);
    this.element.hidden = true;
  }

  Toggle(): void {
    this.element.hidden = !this.element.hidden;
  }
}
