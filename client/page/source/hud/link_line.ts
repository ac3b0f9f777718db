// A line in the middle while the server is silent or does not keep up. A silent server ends the connection after 8 s;
// until then the picture stands still, and people must be told why.
import { MakeElement, SetText } from './element';

const kSilence = 1.5; // s without a word of the server

export enum Link {
  Good,
  Silent,
  Overloaded,
}

// silence: s. pace: of the world, 1: the server keeps up.
export function FindLink(silence: number, pace: number): Link {
  if (silence > kSilence) return Link.Silent;
  return pace < 1 ? Link.Overloaded : Link.Good;
}

export class LinkLine {
  readonly element = MakeElement('div', 'line link-line');

  constructor() {
    this.element.setAttribute('role', 'status');
    this.Hide();
  }

  Hide(): void {
    this.element.hidden = true;
    SetText(this.element, '');
  }

  Update(link: Link, silence: number, pace: number): void {
    this.element.hidden = link === Link.Good;
    SetText(this.element, Describe(link, silence, pace));
  }
}

function Describe(link: Link, silence: number, pace: number): string {
  switch (link) {
    case Link.Good:
      return '';
    case Link.Silent:
      return `The server has been silent for ${silence.toFixed(0)} s`;
    case Link.Overloaded:
      return `The server is overloaded: time runs at ${(100 * pace).toFixed(0)} %`;
  }
}
