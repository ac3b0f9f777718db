// Top right: the connection, the buttons, and the panels that they open.
import type { Command } from '../input/keys';
import { Drawer } from './drawer';
import { MakeButton, MakeElement, SetPressed } from './element';

export type PanelName = 'view' | 'world' | 'settings';

export class Menu {
  readonly drawer: Drawer;
  private readonly m_panels: Record<PanelName, HTMLElement>;
  private readonly m_buttons = new Map<Command, HTMLButtonElement>();

  constructor(chart: HTMLElement, panels: Record<PanelName, HTMLElement>, onCommand: (command: Command) => void) {
    this.m_panels = panels;
    const buttons = MakeElement('div', 'buttons');
    const add = (text: string, label: string, key: string, command: Command) => {
      const button = MakeButton(text, label, key, () => onCommand(command));
      this.m_buttons.set(command, button);
      buttons.append(button);
    };
    add('View', 'View: forces and springs', 'V', 'view');
    add('World', 'World: gravity, stiffness, time', 'G', 'world');
    add('Camera', 'Camera: follow, circle, free', 'C', 'camera');
    add('Settings', 'Settings', '', 'settings');
    add('Full screen', 'Full screen', '', 'fullscreen');
    add('Help', 'Help: what keys and buttons do', 'H', 'help');
    this.m_buttons.get('fullscreen')!.hidden = !document.fullscreenEnabled;
    document.addEventListener('fullscreenchange', () => this.ShowPressed());
    const corner = MakeElement('div', 'corner');
    corner.append(chart, buttons, panels.view, panels.world, panels.settings);
    this.drawer = new Drawer('menu', 'menu', '☰', corner);
    this.ShowPressed();
  }

  Toggle(name: PanelName): void {
    this.m_panels[name].hidden = !this.m_panels[name].hidden;
    this.m_panels[name].scrollIntoView({ block: 'nearest' });
    this.ShowPressed();
  }

  // After a command by a key: opens or closes with its panel what is folded.
  Unfold(command: Command): void {
    if (command === 'view' || command === 'world') this.drawer.Open(!this.m_panels[command].hidden);
  }

  // A browser may refuse; then nothing changes.
  ToggleFullscreen(): void {
    const isFull = document.fullscreenElement !== null;
    const change = isFull ? document.exitFullscreen() : document.documentElement.requestFullscreen();
    change.catch(() => {});
  }

  Close(): void {
    for (const panel of Object.values(this.m_panels)) panel.hidden = true;
    this.drawer.Open(false);
    this.ShowPressed();
  }

  Update(mayTune: boolean): void {
    const button = this.m_buttons.get('world')!;
    if (button.hidden !== mayTune) return;
    button.hidden = !mayTune;
    if (!mayTune) this.m_panels.world.hidden = true;
    this.ShowPressed();
  }

  private ShowPressed(): void {
    for (const name of ['view', 'world', 'settings'] as const) {
      SetPressed(this.m_buttons.get(name)!, !this.m_panels[name].hidden);
    }
    SetPressed(this.m_buttons.get('fullscreen')!, document.fullscreenElement !== null);
  }
}
