// Which device the player uses: the one of the last press. Help, hints and the size of buttons follow it.
import { IsWriting } from './keys';

export enum Device {
  Desk = 'desk', // keyboard and mouse
  Touch = 'touch',
  Pad = 'pad', // gamepad
}

export class DeviceWatch {
  device: Device;
  onChange: () => void = () => {};

  constructor() {
    this.device = window.matchMedia('(pointer: coarse)').matches ? Device.Touch : Device.Desk;
    document.documentElement.dataset.device = this.device;
    const passive = { capture: true, passive: true };
    window.addEventListener(
      'pointerdown',
      (event) => this.Note(event.pointerType === 'touch' ? Device.Touch : Device.Desk),
      passive,
    );
    window.addEventListener('wheel', () => this.Note(Device.Desk), passive);
    // Keyboards on the screen press keys, too, in fields.
    window.addEventListener('keydown', (event) => !IsWriting(event.target) && this.Note(Device.Desk), passive);
  }

  Note(device: Device): void {
    if (device === this.device) return;
    this.device = device;
    document.documentElement.dataset.device = device; // for the style sheet
    this.onChange();
  }
}
