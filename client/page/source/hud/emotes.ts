// Signs over bodies: a row of buttons to show one, and those that are shown, which follow their bodies for some seconds.
// They are drawn as SVG, since not every system has a font of emoji.
import { Vector3, type PerspectiveCamera } from 'three';
import { EmoteKind, type Client } from 'wobble-client';
import type { Players } from '../players';
import { MakeButton, MakeElement } from './element';

const kShownFor = 4; // s
const kAbove = 1.75; // height over the body, in body sizes, as that of its name
const kFace = '<circle cx="12" cy="12" r="10" fill="#ffd35c"/>';
const kEyes = '<circle cx="8.5" cy="9.5" r="1.5"/><circle cx="15.5" cy="9.5" r="1.5"/>';
const kLine = 'fill="none" stroke="#26120a" stroke-width="1.7" stroke-linecap="round"';

// SVG in a square of 24 by 24.
const kEmotes: Record<EmoteKind, [string, string]> = {
  [EmoteKind.Wave]: [
    'Wave',
    `<g fill="none" stroke="#ffd35c" stroke-width="3.1" stroke-linecap="round"><path d="M7 10 9 15M9.6 5.6 12 12M13.4
     4.6 14.6 11M17 6.6 17 13M5 16.6 9 19"/></g><path d="M8 13 17 10.5 18.6 15Q18.4 21.6 13 21.6 9.4 21.6 8 18z"
     fill="#ffd35c"/><path d="M3 8Q3.2 4.4 6 3M20.4 18Q22.2 16 21.6 13" fill="none" stroke="#fff" stroke-width="1.5"
     stroke-linecap="round"/>`,
  ],
  [EmoteKind.Laugh]: [
    'Laugh',
    `${kFace}<path d="M6.5 10Q8.3 7.4 10 10M14 10Q15.7 7.4 17.5 10" ${kLine}/><path d="M6.5 13.5h11q-.6 5-5.5
     5t-5.5-5z" fill="#7a2f12"/>`,
  ],
  [EmoteKind.Love]: [
    'Love',
    '<path d="M12 21 3.4 12.4A5.2 5.2 0 0 1 12 6.6 5.2 5.2 0 0 1 20.6 12.4z" fill="#ff5468"/>',
  ],
  [EmoteKind.Wow]: ['Wow', `${kFace}${kEyes}<ellipse cx="12" cy="16" rx="2.6" ry="3.2" fill="#7a2f12"/>`],
  [EmoteKind.Sad]: [
    'Sad',
    `${kFace}${kEyes}<path d="M8 17.6Q12 13.6 16 17.6" ${kLine}/><path d="M7.4 12.2q-1.8 3 0 3.6 1.8-.6 0-3.6z"
     fill="#3f8fe0"/>`,
  ],
  [EmoteKind.Cheer]: [
    'Cheer',
    `<path d="m12 5 2.2 4.9 5.3.5-4 3.5 1.2 5.3L12 16.4l-4.7 2.8 1.2-5.3-4-3.5 5.3-.5z" fill="#ffd35c"/><path d="M12
     .8v2M3 4l1.5 1.5M21 4l-1.5 1.5M1.2 13h1.6M21.2 13h1.6" fill="none" stroke="#fff" stroke-width="1.6"
     stroke-linecap="round"/>`,
  ],
};

function Draw(kind: EmoteKind): string {
  return `<svg viewBox="0 0 24 24" aria-hidden="true">${kEmotes[kind][1]}</svg>`;
}

interface Shown {
  element: HTMLElement;
  until: number; // s
}

export class Emotes {
  readonly row = MakeElement('div', 'panel emotes');
  onChoose: (kind: EmoteKind) => void = () => {};
  private readonly m_parent: HTMLElement;
  private readonly m_shown = new Map<number, Shown>(); // by body
  private readonly m_place = new Vector3();

  // parent: an element over the world.
  constructor(parent: HTMLElement) {
    this.m_parent = parent;
    this.row.hidden = true;
    this.row.setAttribute('role', 'group');
    this.row.setAttribute('aria-label', 'Emotes');
    for (const [kind, [name]] of Object.values(kEmotes).entries()) {
      const button = MakeButton('', name, String(kind + 1), () => this.Choose(kind));
      button.insertAdjacentHTML('afterbegin', Draw(kind));
      this.row.append(button);
    }
  }

  // From the keyboard: false where there is no such emote.
  Choose(kind: number): boolean {
    if (kEmotes[kind as EmoteKind] === undefined) return false;
    this.row.hidden = true;
    this.onChoose(kind);
    return true;
  }

  Show(body: number, kind: EmoteKind, now: number): void {
    if (kEmotes[kind] === undefined || body === 0) return; // of a newer server
    this.m_shown.get(body)?.element.remove();
    const element = MakeElement('div', 'emote');
    element.innerHTML = Draw(kind);
    element.dataset.emote = kEmotes[kind][0];
    this.m_parent.append(element);
    this.m_shown.set(body, { element, until: now + kShownFor });
  }

  Update(client: Client, players: Players, camera: PerspectiveCamera, now: number): void {
    for (const [body, shown] of this.m_shown) {
      const found = client.findBody(body);
      if (now > shown.until || found === null) {
        shown.element.remove();
        this.m_shown.delete(body);
        continue;
      }
      const size = client.findBlueprint(found.blueprint).size;
      const place = this.m_place.set(found.x, found.y, found.z + kAbove * size).project(camera);
      const x = (0.5 + 0.5 * place.x) * window.innerWidth;
      const y = (0.5 - 0.5 * place.y) * window.innerHeight - (body === players.ownBody ? 0 : 24);
      shown.element.style.visibility = place.z > 1 ? 'hidden' : '';
      shown.element.style.transform = `translate(-50%, -100%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
  }

  Clear(): void {
    for (const { element } of this.m_shown.values()) element.remove();
    this.m_shown.clear();
  }
}
