// What the player chooses for this page and finds again at the next visit: how much is drawn, which camera, how much
// moves.
import { CameraMode } from '../scene/camera';
import { kQualityLevels } from '../scene/quality';
import { KeepSettings, type Settings } from '../settings';
import { MakeElement } from './element';

const kCameras: Record<CameraMode, string> = {
  [CameraMode.Follow]: 'follows your body',
  [CameraMode.Orbit]: 'circles the scene',
  [CameraMode.Free]: 'flies freely',
};

export class SettingsPanel {
  readonly element = MakeElement('section', 'panel rows settings');
  onChange: () => void = () => {};
  private readonly m_settings: Settings;

  // isFixed: the page's address says how much is drawn.
  constructor(settings: Settings, isFixed: boolean) {
    this.m_settings = settings;
    this.element.setAttribute('aria-label', 'Settings');
    this.element.hidden = true;
    const levels: [string, string][] = [['', 'as the device can']];
    for (let level = 0; level < kQualityLevels; ++level) levels.push([String(level), NameLevel(level)]);
    const quality = this.MakeChoice('drawing', levels, String(settings.quality ?? ''), (value) => {
      settings.quality = value === '' ? null : Number(value);
    });
    quality.disabled = isFixed;
    this.MakeChoice('camera at the start', Object.entries(kCameras), settings.camera, (value) => {
      settings.camera = value as CameraMode;
    });
    this.element.prepend(MakeElement('h2', '', 'Settings'));
    this.element.append(this.MakeCalm());
  }

  private MakeChoice(
    text: string,
    values: [string, string][],
    chosen: string,
    choose: (value: string) => void,
  ): HTMLSelectElement {
    const field = MakeElement('label', 'field');
    const select = MakeElement('select');
    for (const [value, name] of values) {
      const option = MakeElement('option', '', name);
      option.value = value;
      option.selected = value === chosen;
      select.append(option);
    }
    select.addEventListener('change', () => {
      choose(select.value);
      this.Keep();
    });
    field.append(MakeElement('span', '', text), select);
    this.element.append(field);
    return select;
  }

  private MakeCalm(): HTMLElement {
    const field = MakeElement('label', 'check');
    const box = MakeElement('input');
    box.type = 'checkbox';
    box.checked = this.m_settings.isCalm;
    box.addEventListener('change', () => {
      this.m_settings.isCalm = box.checked;
      this.Keep();
    });
    field.append(box, 'less motion');
    return field;
  }

  private Keep(): void {
    KeepSettings(this.m_settings);
    this.onChange();
  }
}

function NameLevel(level: number): string {
  if (level === 0) return 'the most';
  return level === kQualityLevels - 1 ? 'the least, for slow devices' : `step ${level}`;
}
