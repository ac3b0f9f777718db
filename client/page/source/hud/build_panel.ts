// The panel above the tool bar in the build tool: the effect of a click, and sliders for the selected part or else for
// the next new one.
import { BuildAction, type Build } from '../tools/build';
import type { ParticleTag, SpringTag } from 'wobble-client';
import { MakeButton, MakeElement, MakeLogarithmicScale, MakeSlider, SetPressed, SetText, type Slider } from './element';

const kMass = MakeLogarithmicScale(0.05, 10); // kg
const kStiffness = MakeLogarithmicScale(5, 20000); // N/m
const kDamping = MakeLogarithmicScale(0.05, 100); // N s/m
const kLength = MakeLogarithmicScale(0.05, 5); // m
const kSendEvery = 120; // ms

function ShowFigure(unit: string) {
  return (value: number) => `${value < 10 ? value.toPrecision(2) : value.toFixed(0)} ${unit}`;
}

export class BuildPanel {
  readonly element = MakeElement('section', 'panel build rows');
  private readonly m_tool: Build;
  private readonly m_actions = new Map<BuildAction, HTMLButtonElement>();
  private readonly m_title = MakeElement('div', 'note');
  private readonly m_mass: Slider;
  private readonly m_stiffness: Slider;
  private readonly m_damping: Slider;
  private readonly m_length: Slider;
  private readonly m_pinned: HTMLButtonElement;
  private readonly m_joins: HTMLButtonElement;
  private m_send: (() => void) | null = null; // the latest change not sent yet

  constructor(tool: Build) {
    this.m_tool = tool;
    this.element.setAttribute('aria-label', 'Build');
    this.element.hidden = true;
    const actions = MakeElement('div', 'row');
    for (const action of Object.values(BuildAction)) {
      const button = MakeButton(action, `${action}: what a click does`, '', () => this.ChooseAction(action));
      this.m_actions.set(action, button);
      actions.append(button);
    }
    this.m_mass = MakeSlider('mass', kMass.toValue, kMass.toShare, ShowFigure('kg'), (value) =>
      this.ChangeParticle({ mass: value }),
    );
    this.m_stiffness = MakeSlider('stiffness k_s', kStiffness.toValue, kStiffness.toShare, ShowFigure('N/m'), (value) =>
      this.ChangeSpring({ stiffness: value }),
    );
    this.m_damping = MakeSlider('damping k_d', kDamping.toValue, kDamping.toShare, ShowFigure('N s/m'), (value) =>
      this.ChangeSpring({ damping: value }),
    );
    this.m_length = MakeSlider('rest length', kLength.toValue, kLength.toShare, ShowFigure('m'), (value) =>
      this.ChangeSpring({ restLength: value }),
    );
    this.m_pinned = MakeButton('Pinned', 'Pinned in its place', '', () => this.TogglePinned());
    this.m_joins = MakeButton('Join to the last', 'A new particle is joined to the selected one', '', () => {
      tool.joinsNew = !tool.joinsNew;
    });
    const flags = MakeElement('div', 'row flags');
    flags.append(this.m_pinned, this.m_joins);
    const sliders = [this.m_mass, this.m_stiffness, this.m_damping, this.m_length].map((each) => each.element);
    this.element.append(actions, this.m_title, flags, ...sliders);
    setInterval(() => this.Flush(), kSendEvery);
  }

  // Call once a frame.
  Update(isActive: boolean): void {
    this.element.hidden = !isActive;
    if (!isActive) return;
    const { particle, spring } = this.m_tool.FindSelection();
    const action = this.m_tool.action;
    for (const [each, button] of this.m_actions) SetPressed(button, each === action);
    SetText(this.m_title, this.Describe(particle, spring));
    const showsSpring = spring !== null || (particle === null && action === BuildAction.Join);
    this.m_mass.element.hidden = this.m_pinned.hidden = showsSpring;
    this.m_stiffness.element.hidden = this.m_damping.element.hidden = !showsSpring;
    this.m_length.element.hidden = spring === null;
    this.m_joins.hidden = action !== BuildAction.Add;
    SetPressed(this.m_joins, this.m_tool.joinsNew);
    SetPressed(this.m_pinned, particle?.fixed ?? this.m_tool.isFixed);
    if (this.m_send !== null) return; // the sliders hold values that the world does not have yet
    this.m_mass.Set(particle?.mass ?? this.m_tool.mass);
    this.m_stiffness.Set(spring?.stiffness ?? this.m_tool.stiffness);
    this.m_damping.Set(spring?.damping ?? this.m_tool.damping);
    if (spring !== null) this.m_length.Set(spring.restLength);
  }

  private Describe(particle: ParticleTag | null, spring: SpringTag | null): string {
    if (particle !== null) return `particle ${particle.number}${particle.fixed ? ', pinned' : ''}`;
    if (spring !== null) return `spring ${spring.number}`;
    switch (this.m_tool.action) {
      case BuildAction.Add:
        return 'Press to place the next particle';
      case BuildAction.Join:
        return 'Press one particle, then another: a spring joins them';
      case BuildAction.Pin:
        return 'Press a particle to pin or release it';
      case BuildAction.Remove:
        return 'Press a particle or a spring to remove it';
      case BuildAction.Select:
        return 'Press a particle or a spring to tune it';
    }
  }

  private ChooseAction(action: BuildAction): void {
    this.m_tool.action = action;
  }

  private TogglePinned(): void {
    const { particle } = this.m_tool.FindSelection();
    if (particle === null) this.m_tool.isFixed = !this.m_tool.isFixed;
    else this.m_tool.SetParticle({ ...particle, fixed: !particle.fixed });
  }

  private ChangeParticle(change: Partial<ParticleTag>): void {
    const { particle } = this.m_tool.FindSelection();
    if (change.mass !== undefined) this.m_tool.mass = change.mass;
    if (particle !== null) this.m_send = () => this.m_tool.SetParticle({ ...particle, ...change });
  }

  private ChangeSpring(change: Partial<SpringTag>): void {
    const { spring } = this.m_tool.FindSelection();
    if (change.stiffness !== undefined) this.m_tool.stiffness = change.stiffness;
    if (change.damping !== undefined) this.m_tool.damping = change.damping;
    if (spring !== null) this.m_send = () => this.m_tool.SetSpring({ ...spring, ...change });
  }

  private Flush(): void {
    this.m_send?.();
    this.m_send = null;
  }
}
