// What the player asks for just now, from keyboard, touch and gamepad together: motion for the body or the free camera,
// turns of the camera, and the tool at the reticle.
import type { Client } from 'wobble-client';
import { CameraMode, type OrbitCamera } from '../scene/camera';
import { Device, DeviceWatch } from './device';
import { Keys, type Command } from './keys';
import { Pad } from './pad';
import type { PointerTaker } from './pointer';
import { Reticle } from './reticle';
import { TouchControls } from './touch_controls';

const kTurnSpeed = 2.6; // rad/s
const kTiltSpeed = 1.7;
const kZoomSpeed = 1.2; // factors of e per second
const kWheelSpeed = 12; // notches per second, while the tool holds something
const kActions = ['jump', 'puff', 'stiffen'];

export class Controls {
  readonly watch = new DeviceWatch();
  readonly touch = new TouchControls();
  readonly reticle: Reticle;
  onCommand: (command: Command) => void = () => {};
  // Called with the name of the action that was used, for the hints.
  onUse: (what: string) => void = () => {};
  private readonly m_keys = new Keys();
  private readonly m_pad = new Pad();
  private readonly m_camera: OrbitCamera;

  constructor(camera: OrbitCamera, taker: PointerTaker) {
    this.m_camera = camera;
    this.reticle = new Reticle(taker);
    this.m_keys.onCommand = this.m_pad.onCommand = (command) => this.onCommand(command);
    this.m_keys.onUse = (what) => this.onUse(what);
  }

  // Call once a frame. client: null while there is no world, when commands act alone. hasBody: the player has one.
  Update(client: Client | null, hasBody: boolean, hasTool: boolean, seconds: number): void {
    this.Act(client, hasBody, hasTool, seconds);
    this.m_keys.EndFrame();
    this.touch.EndFrame();
  }

  private Act(client: Client | null, hasBody: boolean, hasTool: boolean, seconds: number): void {
    this.m_pad.Update(document.querySelector('dialog[open]') !== null);
    if (this.m_pad.isUsed) this.watch.Note(Device.Pad);
    const isFree = this.m_camera.mode === CameraMode.Free;
    const isTouch = this.watch.device === Device.Touch && client !== null;
    this.touch.Show(isTouch && (hasBody || isFree), isTouch && hasBody);
    const hasReticle = client !== null && hasTool;
    const isAiming = this.watch.device === Device.Pad || this.m_keys.Read('use') > 0;
    this.reticle.element.hidden = !hasReticle || !isAiming;
    if (client === null) return;
    this.Move(client, isFree, seconds);
    this.Look(seconds);
    this.reticle.Update(hasReticle && this.Read('use') > 0);
    if (this.m_pad.isUsed) this.NoteUses();
  }

  // Whether a key, a button on the screen or one of the gamepad is held for the action.
  private Read(action: string): number {
    return Math.min(1, this.m_keys.Read(action) + this.touch.Read(action) + this.m_pad.Read(action));
  }

  private Move(client: Client, isFree: boolean, seconds: number): void {
    const keys = this.m_keys;
    const right = keys.Read('right') - keys.Read('left') + this.touch.moveX + this.m_pad.moveX;
    const forward = keys.Read('forward') - keys.Read('back') + this.touch.moveY + this.m_pad.moveY;
    const length = Math.max(1, Math.hypot(right, forward));
    const [jump, puff, stiffen] = kActions.map((action) => this.Read(action) > 0);
    if (isFree) {
      this.m_camera.Fly(right / length, forward / length, this.Read('jump') - this.Read('stiffen'), seconds);
      client.setInput({});
      return;
    }
    const move = this.m_camera.ToWorld(right / length, forward / length);
    client.setInput({ moveX: move.x, moveY: move.y, jump, puff, stiffen });
  }

  private Look(seconds: number): void {
    const keys = this.m_keys;
    const right = keys.Read('lookRight') - keys.Read('lookLeft') + this.m_pad.lookX;
    if (right !== 0 || this.m_pad.lookY !== 0) {
      this.m_camera.Turn(-kTurnSpeed * right * seconds, kTiltSpeed * this.m_pad.lookY * seconds);
      this.onUse('look');
    }
    const way = this.Read('farther') - this.Read('nearer');
    if (way === 0 || this.reticle.Wheel(-way * kWheelSpeed * seconds)) return;
    this.m_camera.Zoom(Math.exp(way * kZoomSpeed * seconds));
  }

  private NoteUses(): void {
    if (this.m_pad.moveX !== 0 || this.m_pad.moveY !== 0) this.onUse('move');
    for (const action of kActions) if (this.m_pad.Read(action) > 0) this.onUse(action);
  }
}
