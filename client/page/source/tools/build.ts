// The build tool: adds, joins, pins and removes particles and springs, and selects the part that the panel tunes.
import { Vector3 } from 'three';
import { BuildKind, Hands, type Blueprint, type Body, type Client } from 'wobble-client';
import type { ParticleTag, SpringTag, Vector } from 'wobble-client';
import { Device } from '../input/device';
import { MakePoint } from '../input/picking';
import type { Place } from '../input/pointer';
import { Project, type Bench, type Tool } from './tool';

export enum BuildAction {
  Select = 'Select',
  Add = 'Particle',
  Join = 'Spring',
  Pin = 'Pin',
  Remove = 'Remove',
}

const kParticleReach = 26; // pixels
const kSpringReach = 12;
const kAboveGround = 0.08; // m of a new particle above the clicked point
const kChainPatience = 2; // s to wait until the server shows a new particle

export interface Selection {
  particle: ParticleTag | null;
  spring: SpringTag | null;
}

interface Found {
  particle: number; // index, -1: none
  spring: number;
}

export class Build implements Tool {
  readonly name = 'Build';
  readonly hand = Hands.Build;
  readonly hints = {
    [Device.Desk]: 'Click to place a particle; click two particles to join them',
    [Device.Touch]: 'Tap to place a particle; tap two particles to join them',
    [Device.Pad]: 'Press RT to place a particle in the ring; two in turn are joined',
  };
  readonly icon =
    'M5 19.5a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM19 19.5a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM12 8a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM6 15.8l5-8M18 15.8l-5-8M7 17.5h10';
  action = BuildAction.Add;
  mass = 0.4; // kg, of new particles
  isFixed = false;
  joinsNew = true; // joins a new particle to the selected one
  stiffness = 400; // N/m, of new springs
  damping = 2; // N s/m
  onChange: () => void = () => {};

  private readonly m_bench: Bench;
  private m_particle = -1; // numbers of the selected particle and spring; -1: none
  private m_spring = -1;
  private m_chain: { from: number; known: Set<number>; until: number } | null = null;
  private readonly m_point = new Vector3();

  constructor(bench: Bench) {
    this.m_bench = bench;
  }

  get selectedParticle(): number {
    return this.m_particle;
  }

  get selectedSpring(): number {
    return this.m_spring;
  }

  // The selection with its present values.
  FindSelection(): Selection {
    const workshop = this.FindWorkshop();
    return {
      particle: workshop?.blueprint.particles.find((tag) => tag.number === this.m_particle) ?? null,
      spring: workshop?.blueprint.springs.find((tag) => tag.number === this.m_spring) ?? null,
    };
  }

  Begin(place: Place): boolean {
    const client = this.m_bench.FindClient();
    if (client === null || (this.m_bench.FindWelcome()?.workshop ?? 0) === 0) return false;
    const workshop = this.FindWorkshop();
    const found = workshop === null ? { particle: -1, spring: -1 } : this.FindAt(place, client, workshop);
    const particle = found.particle < 0 ? null : workshop!.blueprint.particles[found.particle];
    const spring = found.spring < 0 ? null : workshop!.blueprint.springs[found.spring];
    const isTaken = this.Act(client, place, particle, spring);
    if (isTaken) this.onChange();
    return isTaken;
  }

  Move(): void {}
  End(): void {}
  Wheel(): boolean {
    return false;
  }

  // Joins the particle that was added, once the server has shown it.
  Update(): void {
    const client = this.m_bench.FindClient();
    const workshop = this.FindWorkshop();
    if (client === null || workshop === null || this.m_chain === null) return;
    const own = this.m_bench.FindWelcome()?.clientId;
    const isNew = (tag: ParticleTag) => tag.owner === own && !this.m_chain!.known.has(tag.number);
    const fresh = workshop.blueprint.particles.find(isNew);
    if (fresh !== undefined) {
      if (this.m_chain.from >= 0 && this.joinsNew) this.AddSpring(client, this.m_chain.from, fresh.number);
      this.Select(fresh.number, -1);
      this.m_chain = null;
    } else if (performance.now() / 1000 > this.m_chain.until) {
      this.m_chain = null;
    }
  }

  Drop(): void {
    this.m_chain = null;
    this.Select(-1, -1);
  }

  Remove(): void {
    const client = this.m_bench.FindClient();
    if (client === null) return;
    if (this.m_particle >= 0) client.build({ kind: BuildKind.RemoveParticle, a: this.m_particle });
    else if (this.m_spring >= 0) client.build({ kind: BuildKind.RemoveSpring, a: this.m_spring });
    this.Select(-1, -1);
  }

  SetParticle(tag: ParticleTag): void {
    const { number, mass, fixed } = tag;
    this.m_bench.FindClient()?.build({ kind: BuildKind.SetParticle, a: number, mass, fixed });
  }

  SetSpring(tag: SpringTag): void {
    const { number, stiffness, damping, restLength } = tag;
    this.m_bench.FindClient()?.build({ kind: BuildKind.SetSpring, a: number, stiffness, damping, restLength });
  }

  private Select(particle: number, spring: number): void {
    if (particle === this.m_particle && spring === this.m_spring) return;
    this.m_particle = particle;
    this.m_spring = spring;
    this.onChange();
  }

  private Act(client: Client, place: Place, particle: ParticleTag | null, spring: SpringTag | null): boolean {
    switch (this.action) {
      case BuildAction.Add:
        // A click on a particle selects it.
        if (particle === null) return this.AddParticle(client, place);
        this.Select(particle.number, -1);
        return true;
      case BuildAction.Join:
        return particle !== null && this.JoinTo(client, particle.number);
      case BuildAction.Pin:
        if (particle !== null) this.SetParticle({ ...particle, fixed: !particle.fixed });
        return particle !== null;
      case BuildAction.Remove:
        this.Select(particle?.number ?? -1, particle === null ? (spring?.number ?? -1) : -1);
        this.Remove();
        return particle !== null || spring !== null;
      case BuildAction.Select:
        this.Select(particle?.number ?? -1, particle === null ? (spring?.number ?? -1) : -1);
        return particle !== null || spring !== null;
    }
  }

  private AddParticle(client: Client, place: Place): boolean {
    const at = this.FindPlace(place);
    if (at === null) return false;
    client.build({ kind: BuildKind.AddParticle, at, mass: this.mass, fixed: this.isFixed });
    const known = new Set((this.FindWorkshop()?.blueprint.particles ?? []).map((tag) => tag.number));
    this.m_chain = { from: this.m_particle, known, until: performance.now() / 1000 + kChainPatience };
    return true;
  }

  private JoinTo(client: Client, number: number): boolean {
    if (this.m_particle >= 0 && this.m_particle !== number) this.AddSpring(client, this.m_particle, number);
    this.Select(number, -1);
    return true;
  }

  private AddSpring(client: Client, a: number, b: number): void {
    const { stiffness, damping } = this;
    client.build({ kind: BuildKind.AddSpring, a, b, stiffness, damping, restLength: 0 });
  }

  // A point in the plane through the selected particle that faces the camera, or else on the surface beneath the
  // pointer.
  private FindPlace(place: Place): Vector | null {
    this.m_bench.picking.AimAt(place.x, place.y);
    const solid = this.m_bench.picking.FindSolid(this.m_bench.solids);
    const selected = this.FindSelected();
    const facing = selected === null ? null : this.m_bench.picking.FindFacing(selected, this.m_point);
    const eye = this.m_bench.camera.position;
    const isFree = facing !== null && (solid === null || facing.distanceTo(eye) < solid.distanceTo(eye));
    if (isFree) return { x: facing.x, y: facing.y, z: facing.z };
    return solid === null ? null : { x: solid.x, y: solid.y, z: solid.z + kAboveGround };
  }

  private FindSelected(): Vector | null {
    const workshop = this.FindWorkshop();
    const index = workshop?.blueprint.particles.findIndex((tag) => tag.number === this.m_particle) ?? -1;
    if (workshop === null || index < 0) return null;
    return MakePoint(this.m_bench.FindClient()!.readFloats(), workshop.body.vertices + 3 * index);
  }

  private FindWorkshop(): { body: Body; blueprint: Blueprint } | null {
    const client = this.m_bench.FindClient();
    const body = client?.findBody(this.m_bench.FindWelcome()?.workshop ?? 0) ?? null;
    if (client === null || body === null) return null;
    return { body, blueprint: client.findBlueprint(body.blueprint) };
  }

  // Picks on the screen; a particle has priority over the springs that end in it.
  private FindAt(place: Place, client: Client, workshop: { body: Body; blueprint: Blueprint }): Found {
    const { body, blueprint } = workshop;
    const floats = client.readFloats();
    const places: Place[] = [];
    let particle = -1;
    let nearest = kParticleReach;
    for (let i = 0; i < body.vertexCount; ++i) {
      const at = Project(MakePoint(floats, body.vertices + 3 * i), this.m_bench.camera);
      places.push(at);
      const away = Math.hypot(at.x - place.x, at.y - place.y);
      if (away < nearest) {
        nearest = away;
        particle = i;
      }
    }
    if (particle >= 0) return { particle, spring: -1 };
    let spring = -1;
    nearest = kSpringReach;
    for (let i = 0; 2 * i < blueprint.edges.length; ++i) {
      const away = FindAway(place, places[blueprint.edges[2 * i]], places[blueprint.edges[2 * i + 1]]);
      if (away < nearest) {
        nearest = away;
        spring = i;
      }
    }
    return { particle, spring };
  }
}

// Distance of a point from the segment between two others, pixels.
function FindAway(place: Place, from: Place, to: Place): number {
  const x = to.x - from.x;
  const y = to.y - from.y;
  const square = x * x + y * y;
  const along = square > 0 ? ((place.x - from.x) * x + (place.y - from.y) * y) / square : 0;
  const share = Math.max(0, Math.min(1, along));
  return Math.hypot(from.x + share * x - place.x, from.y + share * y - place.y);
}
