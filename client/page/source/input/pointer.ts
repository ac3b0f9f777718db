// Mouse, pen and touch on the world: input for the active tool, and turning the camera.
//
// A press with the left button goes to the tool first. If the tool takes hold of nothing, the press turns the camera,
// as the right button always does. Two fingers pinch to zoom.
import type { OrbitCamera } from '../scene/camera';

const kTurnSpeed = 0.0055; // rad per pixel
const kWheelZoom = 0.0012; // per pixel of the wheel

export interface Place {
  x: number; // pixels
  y: number;
}

// Each function returns whether it used the event.
export interface PointerTaker {
  Begin(place: Place): boolean;
  Move(place: Place): void;
  End(place: Place, isCancelled: boolean): void;
  Wheel(notches: number): boolean;
}

export class Pointer {
  onUse: (what: string) => void = () => {};
  private readonly m_camera: OrbitCamera;
  private readonly m_taker: PointerTaker;
  private readonly m_turning = new Map<number, Place>(); // pointers that turn the camera
  private m_taken: number | null = null; // the pointer used by the tool
  private m_pinch = 0; // pixels between two fingers

  constructor(canvas: HTMLCanvasElement, camera: OrbitCamera, taker: PointerTaker) {
    this.m_camera = camera;
    this.m_taker = taker;
    canvas.addEventListener('pointerdown', (event) => this.Press(canvas, event));
    canvas.addEventListener('pointermove', (event) => this.Move(event));
    canvas.addEventListener('pointerup', (event) => this.Release(event, false));
    canvas.addEventListener('pointercancel', (event) => this.Release(event, true));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.Roll(event), { passive: false });
  }

  private Press(canvas: HTMLCanvasElement, event: PointerEvent): void {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    const place = { x: event.clientX, y: event.clientY };
    const mayTake = event.button === 0 && !event.shiftKey && this.m_taken === null && this.m_turning.size === 0;
    if (mayTake && this.m_taker.Begin(place)) {
      this.m_taken = event.pointerId;
      return;
    }
    this.m_turning.set(event.pointerId, place);
    if (this.m_turning.size === 2) this.m_pinch = this.FindPinch();
  }

  private Move(event: PointerEvent): void {
    const place = { x: event.clientX, y: event.clientY };
    if (event.pointerId === this.m_taken) {
      this.m_taker.Move(place);
      return;
    }
    const before = this.m_turning.get(event.pointerId);
    if (before === undefined) return;
    this.m_turning.set(event.pointerId, place);
    if (this.m_turning.size === 1) {
      this.m_camera.Turn(-kTurnSpeed * (place.x - before.x), kTurnSpeed * (place.y - before.y));
      this.onUse('look');
    } else if (this.m_turning.size === 2) {
      const pinch = this.FindPinch();
      if (pinch > 0 && this.m_pinch > 0) this.m_camera.Zoom(this.m_pinch / pinch);
      this.m_pinch = pinch;
    }
  }

  private Release(event: PointerEvent, isCancelled: boolean): void {
    if (event.pointerId === this.m_taken) {
      this.m_taken = null;
      this.m_taker.End({ x: event.clientX, y: event.clientY }, isCancelled);
    }
    this.m_turning.delete(event.pointerId);
  }

  private Roll(event: WheelEvent): void {
    event.preventDefault();
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 32 * event.deltaY : event.deltaY;
    if (this.m_taken !== null && this.m_taker.Wheel(pixels / 100)) return;
    this.m_camera.Zoom(Math.exp(kWheelZoom * pixels));
    this.onUse('zoom');
  }

  private FindPinch(): number {
    const [a, b] = [...this.m_turning.values()];
    return a !== undefined && b !== undefined ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }
}
