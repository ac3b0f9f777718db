// The quality of the connection: ping, display delay, rate and stalls over the last minute, as lines and figures.
import type { Client } from 'wobble-client';
import { MakeElement, SetText } from './element';

const kEvery = 0.5; // s
const kSamples = 120; // one minute
const kRateOver = 2; // samples

interface Series {
  name: string;
  colour: string;
  floor: number; // the chart's top is at least this value
  show: (value: number) => string;
  values: Float32Array;
}

function MakeSeries(name: string, colour: string, floor: number, show: (value: number) => string): Series {
  return { name, colour, floor, show, values: new Float32Array(kSamples).fill(NaN) };
}

export class LinkChart {
  readonly element = MakeElement('div', 'panel link');
  private readonly m_canvas = MakeElement('canvas');
  private readonly m_figures: HTMLElement[] = [];
  private readonly m_series = [
    MakeSeries('ping', '#ffd166', 80, (value) => `${value.toFixed(0)} ms`),
    MakeSeries('delay', '#7ee0c3', 200, (value) => `${value.toFixed(0)} ms`),
    MakeSeries('kbit/s', '#8ecbff', 300, (value) => value.toFixed(0)),
    MakeSeries('stalls', '#ffa3a3', 4, (value) => value.toFixed(0)),
  ];
  private readonly m_bytes = new Float64Array(kRateOver);
  private m_next = 0;
  private m_samples = 0;
  private m_stalls = 0;

  constructor() {
    const figures = MakeElement('div', 'figures');
    for (const series of this.m_series) {
      const cell = MakeElement('div', '', series.name);
      const value = MakeElement('b', '', '–');
      value.style.setProperty('--series', series.colour);
      cell.prepend(value);
      figures.append(cell);
      this.m_figures.push(value);
    }
    this.m_canvas.setAttribute('role', 'img');
    this.m_canvas.setAttribute('aria-label', 'Ping, delay, rate and stalls over the last minute');
    this.element.append(figures, this.m_canvas);
  }

  // Starts anew for another connection.
  Clear(): void {
    this.m_samples = 0;
    this.m_stalls = 0;
    for (const series of this.m_series) series.values.fill(NaN);
  }

  // ping: s. A ping from before the silence would say that all is well.
  Update(client: Client, ping: number, isSilent: boolean, now: number): void {
    if (now < this.m_next) return;
    this.m_next = now + kEvery;
    const { bytesReceived, delay, stalls } = client.readStatistics();
    const slot = this.m_samples % kRateOver;
    const bytes = this.m_samples < kRateOver ? NaN : bytesReceived - this.m_bytes[slot];
    this.m_bytes[slot] = bytesReceived;
    const values = [
      isSilent ? NaN : ping * 1000,
      delay * 1000,
      (bytes * 8) / 1000 / (kRateOver * kEvery),
      stalls - this.m_stalls,
    ];
    this.m_stalls = stalls;
    this.m_samples += 1;
    this.m_series.forEach((series, i) => {
      series.values.copyWithin(0, 1);
      series.values[kSamples - 1] = values[i];
      SetText(this.m_figures[i], Number.isNaN(values[i]) ? '–' : series.show(values[i]));
    });
    this.Draw();
  }

  private Draw(): void {
    const width = Math.round(this.m_canvas.clientWidth * window.devicePixelRatio);
    const height = Math.round(this.m_canvas.clientHeight * window.devicePixelRatio);
    if (width === 0 || height === 0) return;
    if (this.m_canvas.width !== width) this.m_canvas.width = width;
    if (this.m_canvas.height !== height) this.m_canvas.height = height;
    const context = this.m_canvas.getContext('2d');
    if (context === null) return;
    context.clearRect(0, 0, width, height);
    context.fillStyle = 'rgb(255 255 255 / 12%)';
    for (let i = 1; i < 4; ++i) context.fillRect(0, Math.round((i * height) / 4), width, 1);
    context.lineWidth = 1.5 * window.devicePixelRatio;
    context.lineJoin = 'round';
    for (const series of this.m_series) DrawSeries(context, series, width, height);
  }
}

function DrawSeries(context: CanvasRenderingContext2D, series: Series, width: number, height: number): void {
  let most = series.floor;
  for (const value of series.values) if (value > most) most = value;
  context.strokeStyle = series.colour;
  context.beginPath();
  let isDrawing = false;
  series.values.forEach((value, i) => {
    if (Number.isNaN(value)) return;
    const x = (i / (kSamples - 1)) * width;
    const y = height - 2 - (value / most) * (height - 5);
    if (isDrawing) context.lineTo(x, y);
    else context.moveTo(x, y);
    isDrawing = true;
  });
  context.stroke();
}
