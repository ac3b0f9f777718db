// Draws all bodies of the sample: bodies with faces as surfaces, others as springs and particles.
import { Group } from 'three';
import type { Blueprint, Body, Client } from 'wobble-client';
import type { Players } from '../players';
import { BodyShape } from './body_shape';
import { MakeBodyColour } from './colours';
import { Springs } from './springs';

const kMostFine = 250; // number of bodies up to which surfaces are refined
const kRodShare = 0.09; // rod radius as a share of the spring's rest length, within limits in m
const kThickestRod = 0.018;
const kThinnestRod = 0.006;

export class Bodies {
  readonly group = new Group();
  showsSurface = true;
  // The selected particle or spring of the workshop, by number; marked by colour.
  selectedParticle = -1;
  selectedSpring = -1;

  private readonly m_shapes = new Map<number, BodyShape>();
  private readonly m_lengths = new Map<number, Float32Array>(); // rest lengths of the edges, by blueprint
  private readonly m_springs = new Springs(this.group);
  private readonly m_players: Players;
  private m_dressing = -1;
  private m_round = 0;
  private m_isFine = true;

  constructor(players: Players) {
    this.m_players = players;
  }

  Clear(): void {
    for (const [number, shape] of this.m_shapes) this.Remove(number, shape);
    this.m_lengths.clear();
  }

  // veiled: numbers of the bodies that are see-through. seconds: since the last call.
  Update(client: Client, veiled: ReadonlySet<number>, seconds: number): void {
    this.m_round += 1;
    this.m_springs.Clear();
    this.m_isFine = client.bodyCount <= kMostFine;
    const floats = client.readFloats();
    const isDressed = this.m_dressing === this.m_players.revision;
    for (let i = 0; i < client.bodyCount; ++i) {
      const body = client.bodies[i];
      const blueprint = client.findBlueprint(body.blueprint);
      if (blueprint.faces.length > 0) {
        this.UpdateShape(body, blueprint, floats, isDressed).Veil(veiled.has(body.body), seconds);
      } else {
        this.AddSprings(body, blueprint, floats);
      }
    }
    this.m_dressing = this.m_players.revision;
    for (const [number, shape] of this.m_shapes) if (shape.round !== this.m_round) this.Remove(number, shape);
    this.m_springs.Show();
  }

  private UpdateShape(body: Body, blueprint: Blueprint, floats: Float32Array, isDressed: boolean): BodyShape {
    let shape = this.m_shapes.get(body.body);
    if (shape === undefined) {
      shape = new BodyShape(blueprint, this.m_isFine);
      this.m_shapes.set(body.body, shape);
      this.group.add(shape.mesh, shape.wires);
      this.Dress(body.body, shape);
    } else if (shape.blueprint !== blueprint) {
      shape.TakeBlueprint(blueprint);
      this.Dress(body.body, shape);
    } else if (!isDressed) {
      this.Dress(body.body, shape);
    }
    shape.round = this.m_round;
    shape.Update(body, floats);
    shape.mesh.visible = this.showsSurface;
    shape.wires.visible = !this.showsSurface;
    return shape;
  }

  private Dress(body: number, shape: BodyShape): void {
    shape.Dress(this.m_players.IsPlayer(body), MakeBodyColour(this.m_players, body));
  }

  private Remove(number: number, shape: BodyShape): void {
    this.group.remove(shape.mesh, shape.wires);
    shape.Dispose();
    this.m_shapes.delete(number);
  }

  private AddSprings(body: Body, blueprint: Blueprint, floats: Float32Array): void {
    const lengths = this.FindLengths(blueprint);
    const { edges, particles, springs } = blueprint;
    for (let i = 0; i < lengths.length; ++i) {
      const from = body.vertices + 3 * edges[2 * i];
      const to = body.vertices + 3 * edges[2 * i + 1];
      const length = Math.hypot(
        floats[to] - floats[from],
        floats[to + 1] - floats[from + 1],
        floats[to + 2] - floats[from + 2],
      );
      const rest = springs.length > 0 && springs[i].restLength > 0 ? springs[i].restLength : lengths[i];
      let radius = Math.max(kThinnestRod, Math.min(kThickestRod, kRodShare * rest));
      if (springs.length > 0 && springs[i].number === this.selectedSpring) radius *= 2;
      this.m_springs.AddRod(floats, from, to, radius, rest > 0 ? length / rest - 1 : 0);
    }
    const size = FindDotSize(lengths);
    for (let i = 0; i < body.vertexCount; ++i) {
      const tag = particles.length > 0 ? particles[i] : null;
      const isSelected = tag !== null && tag.number === this.selectedParticle;
      const radius = tag === null ? size : Math.max(0.035, Math.min(0.12, 0.07 * Math.cbrt(tag.mass / 0.5)));
      const [red, green, blue] = isSelected
        ? [1, 0.35, 0.02]
        : tag?.fixed === true
          ? [0.08, 0.1, 0.16]
          : [0.9, 0.62, 0.16];
      this.m_springs.AddDot(floats, body.vertices + 3 * i, isSelected ? 1.3 * radius : radius, red, green, blue);
    }
  }

  private FindLengths(blueprint: Blueprint): Float32Array {
    let lengths = this.m_lengths.get(blueprint.number);
    if (lengths !== undefined) return lengths;
    const { edges, rest } = blueprint;
    lengths = new Float32Array(edges.length / 2);
    for (let i = 0; i < lengths.length; ++i) {
      const from = 3 * edges[2 * i];
      const to = 3 * edges[2 * i + 1];
      lengths[i] = Math.hypot(rest[to] - rest[from], rest[to + 1] - rest[from + 1], rest[to + 2] - rest[from + 2]);
    }
    if (this.m_lengths.size > 64) this.m_lengths.clear();
    this.m_lengths.set(blueprint.number, lengths);
    return lengths;
  }
}

function FindDotSize(lengths: Float32Array): number {
  let sum = 0;
  for (const length of lengths) sum += length;
  const mean = lengths.length > 0 ? sum / lengths.length : 0.4;
  return Math.max(0.015, Math.min(0.06, 0.14 * mean));
}
