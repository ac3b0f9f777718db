// What the device in use can do, above the world until it is closed. It changes when another device is used.
import { Device } from '../input/device';
import { HasPads } from '../input/pad';
import { MakeButton, MakeDialog, MakeElement } from './element';

type Line = [keys: string, text: string];

// What a player may do here: lines about other things would be untrue.
export interface Abilities {
  hasBody: boolean;
  hasTools: boolean;
  mayTune: boolean;
}

const kTitles: Record<Device, string> = {
  [Device.Desk]: 'Keyboard and mouse',
  [Device.Touch]: 'Touch',
  [Device.Pad]: 'Gamepad',
};

function ListDesk({ hasBody, hasTools, mayTune }: Abilities): Line[] {
  const body: Line[] = [
    ['W A S D, arrows', 'move in the direction of view'],
    ['Space', 'jump'],
    ['E or P', 'puff up'],
    ['F', 'stiffen'],
  ];
  const tools: Line[] = [
    ['1 2 3 4', 'choose a tool'],
    ['left button', 'use the tool on a body; elsewhere: look around'],
    ['U', 'use the tool at a ring above your own body, without a mouse'],
  ];
  return [
    ...(hasBody ? body : []),
    ...(hasTools ? tools : []),
    ['right button', 'look around; without a mouse: comma, full stop'],
    ['wheel, Page keys', hasTools ? 'zoom; while grabbing: nearer or farther' : 'zoom'],
    ['C', hasBody ? 'camera: follow, circle, free' : 'camera: circle, free; the keys of motion fly it'],
    ['V', 'view: forces, accelerations, springs'],
    ['X', 'surfaces on and off'],
    ...(mayTune ? ([['G', 'world: gravity, stiffness, time']] satisfies Line[]) : []),
    ['Y', 'ready for the match, in the lobby of a game'],
    ['T or Enter', 'say a line to all'],
    ['Q', 'show an emote: then 1 to 6'],
    ['H or ?', 'this list'],
  ];
}

function ListTouch({ hasBody, hasTools, mayTune }: Abilities): Line[] {
  const body: Line[] = [
    ['stick', 'move in the direction of view'],
    ['Jump', 'jump'],
    ['Puff', 'puff up, as long as you hold it'],
    ['Stiff', 'stiffen, as long as you hold it'],
  ];
  const tools: Line[] = [['bottom row', 'choose a tool; use it on a body with a finger']];
  return [
    ...(hasBody ? body : []),
    ...(hasTools ? tools : []),
    ['drag', hasTools ? 'look around, beside a body' : 'look around'],
    ['pinch', 'zoom'],
    ['menu, top right', mayTune ? 'view, world, camera, settings' : 'view, camera, settings'],
    ['name, top left', 'players, other worlds, invite friends'],
  ];
}

function ListPad({ hasBody, hasTools }: Abilities): Line[] {
  const body: Line[] = [
    ['left stick', 'move in the direction of view'],
    ['A', 'jump'],
    ['B', 'puff up'],
    ['X', 'stiffen'],
  ];
  const tools: Line[] = [
    ['LB RB', 'choose a tool'],
    ['RT', 'use the tool at the ring'],
  ];
  return [
    ...(hasBody ? body : []),
    ...(hasTools ? tools : []),
    ['right stick', 'look around'],
    ['pad up, down', hasTools ? 'zoom; while grabbing: nearer or farther' : 'zoom'],
    ['Y', hasBody ? 'camera: follow, circle, free' : 'camera: circle, free; the left stick flies it'],
    ['Back', 'view: forces, accelerations, springs'],
    ['Start', 'this list; B closes it'],
  ];
}

const kLists: Record<Device, (abilities: Abilities) => Line[]> = {
  [Device.Desk]: ListDesk,
  [Device.Touch]: ListTouch,
  [Device.Pad]: ListPad,
};

function DescribePads(): string {
  if (HasPads()) return 'A gamepad works, too: press one of its buttons.';
  return 'Browsers pass on gamepads to pages of https and of localhost alone, and this page is neither.';
}

export class Help {
  readonly element = MakeDialog('card help', 'Help');
  private readonly m_title = MakeElement('h1');
  private readonly m_list = MakeElement('dl', 'keys');
  private readonly m_note = MakeElement('p');
  private m_device = Device.Desk;
  private m_abilities: Abilities = { hasBody: true, hasTools: true, mayTune: false };

  constructor() {
    const close = MakeButton('Continue', 'Continue', '', () => this.element.close());
    close.classList.add('main');
    this.element.append(this.m_title, this.m_list, this.m_note, close);
    this.element.addEventListener('keydown', (event) => {
      if (event.code === 'KeyH' || event.key === '?') this.element.close();
    });
    this.List();
  }

  Toggle(abilities: Abilities): void {
    if (this.element.open) return this.element.close();
    this.m_abilities = abilities;
    this.List();
    this.element.showModal();
  }

  // The device that is used from now on.
  Speak(device: Device): void {
    this.m_device = device;
    this.List();
  }

  private List(): void {
    this.m_title.textContent = kTitles[this.m_device];
    this.m_list.replaceChildren();
    for (const [keys, text] of kLists[this.m_device](this.m_abilities)) {
      const term = MakeElement('dt');
      term.append(MakeElement('kbd', '', keys));
      this.m_list.append(term, MakeElement('dd', '', text));
    }
    this.m_note.textContent = this.m_device === Device.Desk ? DescribePads() : '';
    this.m_note.hidden = this.m_device !== Device.Desk;
  }
}
