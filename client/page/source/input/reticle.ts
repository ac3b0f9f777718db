// A point of the screen at which the tool acts for who has no pointer: by a gamepad's trigger, or a key. It lies above
// the player's own body and so looks past it.
import { MakeElement } from '../hud/element';
import type { Place, PointerTaker } from './pointer';

const kAcross = 0.5; // shares of the screen
const kDown = 0.46;

export class Reticle {
  readonly element = MakeElement('div', 'reticle');
  private readonly m_taker: PointerTaker;
  private m_wasHeld = false;
  private m_takes = false; // the tool holds on to what it found

  constructor(taker: PointerTaker) {
    this.m_taker = taker;
    this.element.hidden = true;
    this.element.style.left = `${100 * kAcross}%`;
    this.element.style.top = `${100 * kDown}%`;
  }

  // Call once a frame. isHeld: whether the tool is to act.
  Update(isHeld: boolean): void {
    const place: Place = { x: kAcross * window.innerWidth, y: kDown * window.innerHeight };
    if (isHeld && !this.m_wasHeld) this.m_takes = this.m_taker.Begin(place);
    else if (isHeld && this.m_takes) this.m_taker.Move(place);
    else if (this.m_takes) {
      this.m_takes = false;
      this.m_taker.End(place, false);
    }
    this.m_wasHeld = isHeld;
  }

  // Moves what the tool holds; false when it holds nothing. notches: away from the player when negative.
  Wheel(notches: number): boolean {
    return this.m_takes && this.m_taker.Wheel(notches);
  }
}
