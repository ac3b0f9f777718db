// The display of bodies: the forces on one body by kind, springs in place of surfaces, and the own body ahead of the others.
import { kForceColours } from '../scene/arrows';
import { ForceKind } from 'wobble-client';
import { Keep, ReadKept } from '../storage';
import { MakeButton, MakeElement, SetPressed, SetText } from './element';

const kForces = [
  ForceKind.Elastic,
  ForceKind.Damping,
  ForceKind.Gas,
  ForceKind.Weight,
  ForceKind.Contact,
  ForceKind.Other,
];

const kPredictKey = 'wobble.predict';

// ?predict=0 or 1 comes before what was chosen here.
function ReadPredicts(): boolean {
  const asked = new URLSearchParams(location.search).get('predict');
  return (asked ?? ReadKept(kPredictKey)) !== '0';
}

export class ViewPanel {
  readonly element = MakeElement('section', 'panel rows');
  readonly shown = new Set<ForceKind>();
  showsSurface = true;
  predicts = ReadPredicts();
  onChange: () => void = () => {};
  private readonly m_forces: HTMLButtonElement;
  private readonly m_accelerations: HTMLButtonElement;
  private readonly m_surface: HTMLButtonElement;
  private readonly m_predicts: HTMLButtonElement;
  private readonly m_legend = MakeElement('div', 'legend');
  private readonly m_of = MakeElement('div', 'note');

  constructor() {
    this.element.setAttribute('aria-label', 'View');
    this.element.hidden = true;
    this.m_forces = MakeButton('Forces', 'Show forces as arrows', '', () => this.Toggle(kForces));
    this.m_accelerations = MakeButton('Accelerations', 'Show accelerations as arrows', '', () =>
      this.Toggle([ForceKind.Acceleration]),
    );
    this.m_surface = MakeButton('Surface', 'Surface; off: the springs beneath', 'X', () => this.ToggleSurface());
    this.m_predicts = MakeButton('No delay', 'No delay: show your own body at once; off: as the server has it', '', () => {
      this.predicts = !this.predicts;
      Keep(kPredictKey, this.predicts ? '1' : '0');
      this.Show();
    });
    const first = MakeElement('div', 'row');
    first.append(this.m_forces, this.m_accelerations);
    const second = MakeElement('div', 'row');
    second.append(this.m_surface, this.m_predicts);
    this.MakeLegend();
    this.element.append(MakeElement('h2', '', 'View'), first, this.m_legend, this.m_of, second);
    this.Show();
  }

  ToggleSurface(): void {
    this.showsSurface = !this.showsSurface;
    this.Show();
  }

  // Names the body whose forces are shown.
  Describe(text: string): void {
    SetText(this.m_of, this.shown.size === 0 ? '' : text);
  }

  private Toggle(kinds: ForceKind[]): void {
    const isShown = kinds.some((kind) => this.shown.has(kind));
    for (const kind of kinds) {
      if (isShown) this.shown.delete(kind);
      else this.shown.add(kind);
    }
    this.Show();
  }

  private Show(): void {
    SetPressed(this.m_forces, this.shown.has(ForceKind.Elastic));
    SetPressed(this.m_accelerations, this.shown.has(ForceKind.Acceleration));
    SetPressed(this.m_surface, this.showsSurface);
    SetPressed(this.m_predicts, this.predicts);
    this.m_legend.hidden = !this.shown.has(ForceKind.Elastic);
    this.onChange();
  }

  private MakeLegend(): void {
    for (const kind of kForces) {
      const line = MakeElement('div', '', ForceKind[kind].toLowerCase());
      const colour = MakeElement('i');
      colour.style.setProperty('--series', kForceColours[kind]);
      line.prepend(colour);
      this.m_legend.append(line);
    }
  }
}
