// The worlds and recordings to choose from, the purpose of the chosen world, and links to worlds of other gateways.
import { FetchOffer, FindPurpose, FormatTime, type Elsewhere, type Offer, type Recording } from '../worlds';
import { MakeButton, MakeElement, SetPressed, SetText } from './element';

const kListEvery = 3000; // ms, while the list of recordings is open

export class WorldMenu {
  readonly element = MakeElement('nav', 'worlds');
  onChoose: (world: string) => void = () => {};
  private readonly m_buttons = new Map<string, HTMLButtonElement>();
  private readonly m_purpose = MakeElement('p', 'note');
  private readonly m_recordings = MakeElement('details');
  private readonly m_list = MakeElement('div', 'recordings');
  private m_chosen = '';

  constructor() {
    this.element.setAttribute('aria-label', 'Worlds');
    this.m_recordings.append(MakeElement('summary', '', 'Recordings'), this.m_list);
    const list = () => {
      if (this.m_recordings.open) void FetchOffer().then(({ recordings }) => this.ListRecordings(recordings ?? []));
    };
    this.m_recordings.addEventListener('toggle', list);
    setInterval(list, kListEvery);
  }

  // Hidden when there is only one world and nothing else.
  List({ worlds, recordings, elsewhere }: Offer): void {
    for (const world of worlds.length === 0 ? [''] : worlds) {
      const name = world === '' ? 'the world' : world;
      const button = MakeButton(name, `Play ${name}`, '', () => this.onChoose(world));
      this.m_buttons.set(world, button);
      this.element.append(button);
    }
    this.element.append(this.m_purpose);
    if (recordings !== null) this.element.append(this.m_recordings);
    this.ListRecordings(recordings ?? []);
    if (elsewhere.length > 0) this.element.append(MakeElsewhere(elsewhere));
    this.element.hidden = worlds.length < 2 && recordings === null && elsewhere.length === 0;
  }

  Show(chosen: string): void {
    this.m_chosen = chosen;
    for (const [name, button] of this.m_buttons) SetPressed(button, name === chosen);
    SetText(this.m_purpose, FindPurpose(chosen));
  }

  // An entry that says the same stays where it is: somebody may be pressing it.
  private ListRecordings(recordings: readonly Recording[]): void {
    const shown = [...this.m_list.querySelectorAll('button')];
    const entries = recordings.map((recording) => this.FindEntry(recording));
    const isShown = ({ dataset }: HTMLElement, i: number) => dataset.file === shown[i].dataset.file;
    const isSameList = entries.length > 0 && entries.length === shown.length && entries.every(isShown);
    if (isSameList) {
      entries.forEach((entry, i) => entry !== shown[i] && shown[i].replaceWith(entry));
    } else {
      const files = new Set(recordings.map(({ file }) => file));
      for (const { dataset } of shown) if (!files.has(dataset.file!)) this.m_buttons.delete(dataset.file!);
      this.m_list.replaceChildren(...entries);
    }
    if (recordings.length === 0) this.m_list.append(MakeElement('p', 'note', 'There are none yet.'));
    this.Show(this.m_chosen);
  }

  private FindEntry(recording: Recording): HTMLButtonElement {
    const known = this.m_buttons.get(recording.file);
    return known?.dataset.says === JSON.stringify(recording) ? known : this.MakeEntry(recording);
  }

  private MakeEntry(recording: Recording): HTMLButtonElement {
    const { file, scene, seconds, writtenAt, fault, damage } = recording;
    const when = new Date(1000 * writtenAt).toLocaleString([], { dateStyle: 'short', timeStyle: 'medium' });
    const note = damage === undefined ? `${when}, ${file}` : `${when}, ${file}, damaged`;
    const button = MakeButton(scene === '' ? file : `${scene} ${FormatTime(seconds)}`, `Watch ${file}`, '', () =>
      this.onChoose(file),
    );
    button.append(MakeElement('span', 'note', fault === undefined ? note : `It ${fault}.`));
    button.disabled = fault !== undefined;
    button.dataset.file = file;
    button.dataset.says = JSON.stringify(recording);
    this.m_buttons.set(file, button);
    return button;
  }
}

// Names are text of others; the pages open in tabs of their own and are not told where from.
function MakeElsewhere(elsewhere: readonly Elsewhere[]): HTMLElement {
  const list = MakeElement('div', 'recordings');
  for (const { name, page, scene } of elsewhere) {
    const link = MakeElement('a', '', name);
    link.href = page;
    link.target = '_blank';
    link.rel = 'noopener noreferrer';
    link.append(MakeElement('span', 'note', [scene, link.host].filter((each) => each !== '').join(' · ')));
    list.append(link);
  }
  const element = MakeElement('details');
  element.append(MakeElement('summary', '', 'Elsewhere'), list);
  return element;
}
