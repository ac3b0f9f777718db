// Lines and rings above the picture that show the tool's effect. Redrawn in each frame that has any.

interface Ring {
  x: number;
  y: number;
  born: number;
}

const kRingFor = 0.35; // s
const kRingSize = 46; // pixels, at the end
const kStrokeFor = 0.3; // s for which a stroke's points are shown

export class Marks {
  private readonly m_canvas: HTMLCanvasElement;
  private readonly m_context: CanvasRenderingContext2D;
  private readonly m_rings: Ring[] = [];
  private readonly m_stroke: Ring[] = [];
  private m_isEmpty = true;
  // Lines of this frame: x and y of both ends, pixels.
  private readonly m_lines: { points: [number, number, number, number]; colour: string }[] = [];

  constructor(canvas: HTMLCanvasElement) {
    this.m_canvas = canvas;
    this.m_context = canvas.getContext('2d')!;
    canvas.hidden = true;
  }

  AddRing(x: number, y: number, now: number): void {
    this.m_rings.push({ x, y, born: now });
  }

  // Adds the next point of a stroke.
  AddStroke(x: number, y: number, now: number): void {
    this.m_stroke.push({ x, y, born: now });
  }

  // Adds a line for the next Draw only.
  AddLine(x0: number, y0: number, x1: number, y1: number, colour: string): void {
    this.m_lines.push({ points: [x0, y0, x1, y1], colour });
  }

  Draw(now: number): void {
    while (this.m_rings.length > 0 && now - this.m_rings[0].born > kRingFor) this.m_rings.shift();
    while (this.m_stroke.length > 0 && now - this.m_stroke[0].born > kStrokeFor) this.m_stroke.shift();
    const isEmpty = this.m_rings.length + this.m_stroke.length + this.m_lines.length === 0;
    if (isEmpty && this.m_isEmpty) return;
    this.m_isEmpty = isEmpty;
    this.m_canvas.hidden = isEmpty; // even an empty canvas above the world costs time
    this.Clear();
    this.DrawStroke(now);
    this.DrawRings(now);
    this.DrawLines();
    this.m_lines.length = 0;
  }

  private Clear(): void {
    const width = window.innerWidth;
    const height = window.innerHeight;
    if (this.m_canvas.width !== width) this.m_canvas.width = width;
    if (this.m_canvas.height !== height) this.m_canvas.height = height;
    this.m_context.clearRect(0, 0, width, height);
    this.m_context.lineCap = 'round';
  }

  private DrawStroke(now: number): void {
    const context = this.m_context;
    for (let i = 1; i < this.m_stroke.length; ++i) {
      const from = this.m_stroke[i - 1];
      const to = this.m_stroke[i];
      const life = 1 - (now - to.born) / kStrokeFor;
      context.strokeStyle = `rgb(255 255 255 / ${(90 * life).toFixed(0)}%)`;
      context.lineWidth = 1 + 5 * life;
      context.beginPath();
      context.moveTo(from.x, from.y);
      context.lineTo(to.x, to.y);
      context.stroke();
    }
  }

  private DrawRings(now: number): void {
    for (const ring of this.m_rings) {
      const age = (now - ring.born) / kRingFor;
      this.m_context.strokeStyle = `rgb(255 255 255 / ${(90 * (1 - age)).toFixed(0)}%)`;
      this.m_context.lineWidth = 5 * (1 - age) + 1;
      this.m_context.beginPath();
      this.m_context.arc(ring.x, ring.y, 6 + kRingSize * Math.sqrt(age), 0, 2 * Math.PI);
      this.m_context.stroke();
    }
  }

  private DrawLines(): void {
    const context = this.m_context;
    for (const { points, colour } of this.m_lines) {
      context.strokeStyle = context.fillStyle = colour;
      context.lineWidth = 3;
      context.setLineDash([2, 7]);
      context.beginPath();
      context.moveTo(points[0], points[1]);
      context.lineTo(points[2], points[3]);
      context.stroke();
      context.setLineDash([]);
      for (const i of [0, 2]) {
        context.beginPath();
        context.arc(points[i], points[i + 1], i === 0 ? 5 : 7, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }
}
