// The interface for tests: window.wobble. The page itself does not use it.
import type { App } from './app';
import { MakePoint } from './input/picking';
import { Project } from './tools/tool';
import { ForceKind, State, type ParticleTag, type SpringTag, type Tuning, type Vector } from 'wobble-client';

export interface Probe {
  state(): {
    connection: string;
    scene: string;
    ownBody: number;
    watched: number; // body that the camera follows
    focus: Vector; // of the camera
    eye: Vector;
    yaw: number; // rad
    veiled: number[]; // bodies that are see-through
    players: string[];
    bodies: number;
    frameMs: number;
    quality: number;
    endReason: string;
  };
  statistics(): Record<string, number>;
  position(body: number): Vector | null;
  bodies(): { body: number; name: string; faces: number; edges: number; vertices: number; at: Vector }[];
  faceCount(body: number): number;
  edgeCount(body: number): number;
  vertex(body: number, vertex: number): Vector | null;
  // Screen position of a point of the world, pixels.
  place(point: Vector): { x: number; y: number };
  tuning(): Tuning | null;
  // Kinds of the forces received, and their body.
  forces(): { body: number; kinds: string[] };
  workshop(): { particles: ParticleTag[]; springs: SpringTag[] };
  selected(): { particle: number; spring: number };
  // The newest thuds that were played.
  thuds(): { body: number; speed: number }[];
  decodedHash(): string;
  // False, and nothing is done, while blueprints that have come cannot be decoded with yet.
  restartDecodedHash(): boolean;
}

declare global {
  interface Window {
    wobble?: Probe;
  }
}

export function MakeProbe(app: App): Probe {
  const client = () => app.connection.client;
  const find = (body: number) => client()?.findBody(body) ?? null;
  const blueprint = (body: number) => {
    const found = find(body);
    return found === null ? null : client()!.findBlueprint(found.blueprint);
  };
  return {
    state: () => ({
      connection: State[client()?.readState() ?? State.Ended],
      scene: app.welcome?.scene ?? '',
      ownBody: app.players.ownBody,
      watched: app.players.FindWatchedBody(),
      focus: { ...app.camera.focus },
      eye: app.camera.FindEye(),
      yaw: app.camera.yaw,
      veiled: [...app.veil.bodies],
      players: [...app.players.all.values()].map((player) => player.name),
      bodies: client()?.bodyCount ?? 0,
      frameMs: Math.round(1000 * app.quality.frameTime),
      quality: app.quality.level,
      endReason: app.connection.lostReason,
    }),
    statistics: () => ({ ...client()?.readStatistics(), ping: app.connection.ping }),
    position: (body) => {
      const found = find(body);
      return found === null ? null : { x: found.x, y: found.y, z: found.z };
    },
    bodies: () => {
      const list = [];
      for (let i = 0; i < (client()?.bodyCount ?? 0); ++i) {
        const { body, x, y, z, vertexCount } = client()!.bodies[i];
        const { name, faces, edges } = blueprint(body)!;
        const at = { x, y, z };
        list.push({ body, name, faces: faces.length / 3, edges: edges.length / 2, vertices: vertexCount, at });
      }
      return list;
    },
    faceCount: (body) => (blueprint(body)?.faces.length ?? 0) / 3,
    edgeCount: (body) => (blueprint(body)?.edges.length ?? 0) / 2,
    vertex: (body, vertex) => {
      const found = find(body);
      return found === null ? null : MakePoint(client()!.readFloats(), found.vertices + 3 * vertex);
    },
    place: (point) => Project(point, app.stage.camera),
    tuning: () => client()?.readTuning() ?? null,
    forces: () => {
      const forces = client()?.readForces();
      return { body: forces?.body ?? 0, kinds: (forces?.fields ?? []).map((field) => ForceKind[field.kind]) };
    },
    workshop: () => {
      const { particles, springs } = blueprint(app.welcome?.workshop ?? 0) ?? { particles: [], springs: [] };
      return { particles, springs };
    },
    selected: () => ({ particle: app.bodies.selectedParticle, spring: app.bodies.selectedSpring }),
    thuds: () => app.sound.played.map(({ body, speed }) => ({ body, speed })),
    decodedHash: () => client()?.readDecodedHash() ?? '',
    restartDecodedHash: () => {
      const present = client();
      if (present === null || present.isCompleting()) return false;
      present.restartDecodedHash();
      return true;
    },
  };
}
