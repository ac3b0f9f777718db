// The line of time of a recording that the server shows. Everybody who watches winds the same one, by orders; where it
// stands the server says as a notice, when it is asked.
import type { Client } from 'wobble-client';
import { FormatTime } from '../worlds';
import { MakeButton, MakeElement, MakeSlider, SetPressed, SetText, type Slider } from './element';

export const kFilm = 'film'; // the game of a welcome to a recording

const kAskEvery = 0.4; // s
const kSendEvery = 0.15; // s, while the slider is dragged
const kPlace = /^(plays|paused at) (\d+):([\d.]+) of (\d+):([\d.]+), speed (-?[\d.]+), tick \d+(?:, on the way to [\d:.]+)?$/;
const kSpeeds = [-4, -1, 0.25, 1, 4, 16];

interface Place {
  isPlaying: boolean;
  time: number; // s
  end: number; // s
  speed: number;
}

export function ReadPlace(notice: string): Place | null {
  const found = kPlace.exec(notice);
  if (found === null) return null;
  const [minutes, seconds, endMinutes, endSeconds, speed] = found.slice(2).map(Number) as [
    number,
    number,
    number,
    number,
    number,
  ];
  return {
    isPlaying: found[1] === 'plays',
    time: 60 * minutes + seconds,
    end: 60 * endMinutes + endSeconds,
    speed,
  };
}

export class FilmPanel {
  readonly element = MakeElement('section', 'panel rows film');
  private readonly m_time: Slider;
  private readonly m_toggle: HTMLButtonElement;
  private readonly m_speeds: HTMLButtonElement[];
  private m_place: Place = { isPlaying: true, time: 0, end: 0, speed: 1 };
  private m_client: Client | null = null;
  private m_nextAsk = 0;
  private m_wanted: number | null = null; // s; where the slider was dragged to last
  private m_nextSend = 0;

  constructor() {
    this.element.setAttribute('aria-label', 'Recording');
    this.element.hidden = true;
    this.m_time = MakeSlider(
      'recording',
      (share) => share * this.m_place.end,
      (time) => (this.m_place.end > 0 ? time / this.m_place.end : 0),
      (time) => `${FormatTime(time)} of ${FormatTime(this.m_place.end)}`,
      (time) => (this.m_wanted = time),
    );
    const order = (line: string) => () => this.Order(line);
    this.m_toggle = MakeButton('pause', 'Play or pause', '', () => this.Order(this.m_place.isPlaying ? 'pause' : 'play'));
    const steps = MakeElement('div', 'row');
    steps.append(
      MakeButton('−5 s', 'Five seconds back', '', order('by -5')),
      MakeButton('−1', 'One tick back', '', order('step -1')),
      this.m_toggle,
      MakeButton('+1', 'One tick on', '', order('step 1')),
      MakeButton('+5 s', 'Five seconds on', '', order('by 5')),
    );
    this.m_speeds = kSpeeds.map((speed) => MakeButton(speed === 0.25 ? '× ¼' : `× ${speed}`, `Speed ${speed}`, '', order(`speed ${speed}`)));
    const speeds = MakeElement('div', 'row');
    speeds.append(...this.m_speeds);
    this.element.append(this.m_time.element, steps, speeds);
  }

  Hide(): void {
    this.element.hidden = true;
    this.m_client = null;
  }

  // now: s.
  Update(client: Client, now: number): void {
    this.element.hidden = false;
    this.m_client = client;
    if (this.m_wanted !== null && now >= this.m_nextSend) {
      this.m_nextSend = now + kSendEvery;
      this.Order(`to ${this.m_wanted.toFixed(2)}`);
      this.m_wanted = null;
    }
    if (now < this.m_nextAsk) return;
    this.m_nextAsk = now + kAskEvery;
    client.order(kFilm);
  }

  // Whether the notice said where the recording stands, and is not for people.
  TakeNotice(notice: string): boolean {
    const place = ReadPlace(notice);
    if (place === null) return false;
    this.m_place = place;
    if (this.m_wanted === null) this.m_time.Set(place.time);
    SetText(this.m_toggle, place.isPlaying ? 'pause' : 'play');
    this.m_speeds.forEach((button, i) => SetPressed(button, kSpeeds[i] === place.speed));
    return true;
  }

  private Order(words: string): void {
    this.m_client?.order(`${kFilm} ${words}`);
  }
}
