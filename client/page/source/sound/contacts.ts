// Finds in the motion of bodies where one has hit something: where it was slowed down harder than gravity, the ground
// under a body at rest, and a player's walking can explain. The server sends no contacts, so there is nothing else to go
// by; a body that is struck while it lies still is heard by the one that struck it.
//
// It imports nothing, so that a test runs it alone.

export interface MovingBody {
  body: number;
  x: number;
  y: number;
  z: number;
  size: number; // m
  isPlayer: boolean;
  isHeld: boolean; // shown as it was, because news of it is missing
}

export interface Thud {
  body: number;
  x: number;
  y: number;
  z: number;
  size: number; // m
  speed: number; // with which it came, along the push that stopped it, m/s
}

const kStep = 0.04; // s between two places that are compared; a soft ball is in contact for 0.1 to 0.2 s
const kLongestStep = 0.2; // s; after a longer gap it begins anew
const kFastest = 80; // m/s; what is faster was put somewhere else
// Decelerations that are no hit, m/s²: of places that are rounded to 2 mm, and of a player's walking.
const kNoise = 14;
const kWalking = 30;
const kSudden = 10; // m/s² by which a push grows within a step; a hand that drags a body grows more slowly
const kSlowest = 0.8; // m/s; slower contacts are silent
const kRest = 0.2; // s between two thuds of a body

interface Track {
  round: number;
  steps: number; // places so far
  at: number; // s, of the newest place
  place: number[];
  velocity: number[]; // up to the newest place
  before: number[]; // up to the place before
  push: number[]; // acceleration at the newest place
  last: number; // s, of the last thud
  isArmed: boolean; // false: the contact that was heard goes on
}

export class ContactFinder {
  private readonly m_tracks = new Map<number, Track>();
  private m_round = 0;

  // The body is put somewhere else.
  Forget(body: number): void {
    this.m_tracks.delete(body);
  }

  Clear(): void {
    this.m_tracks.clear();
  }

  // bodies: all that are shown. now: s, never backwards. gravity: z of the acceleration of all bodies, m/s².
  Update(bodies: Iterable<MovingBody>, now: number, gravity: number): Thud[] {
    const thuds: Thud[] = [];
    this.m_round += 1;
    for (const body of bodies) {
      const track = this.FindTrack(body, now);
      track.round = this.m_round;
      if (now - track.at < kStep) continue;
      const speed = this.Follow(track, body, now, gravity);
      if (speed === 0) continue;
      thuds.push({ body: body.body, x: body.x, y: body.y, z: body.z, size: body.size, speed });
    }
    for (const [body, track] of this.m_tracks) if (track.round !== this.m_round) this.m_tracks.delete(body);
    return thuds;
  }

  private FindTrack(body: MovingBody, now: number): Track {
    const known = this.m_tracks.get(body.body);
    if (known !== undefined && !body.isHeld && now - known.at < kLongestStep) return known;
    const fresh: Track = {
      round: 0,
      steps: 0,
      at: now,
      place: [body.x, body.y, body.z],
      velocity: [0, 0, 0],
      before: [0, 0, 0],
      push: [0, 0, 0],
      last: known?.last ?? -kRest,
      isArmed: true,
    };
    this.m_tracks.set(body.body, fresh);
    return fresh;
  }

  // Takes the next place. Returns the speed of a hit; 0: there was none.
  private Follow(track: Track, body: MovingBody, now: number, gravity: number): number {
    const seconds = now - track.at;
    const place = [body.x, body.y, body.z];
    const velocity = place.map((each, i) => (each - track.place[i]) / seconds);
    const [older, newer] = [track.before, track.velocity];
    const push = velocity.map((each, i) => (each - newer[i]) / seconds);
    const growth = Math.hypot(...push.map((each, i) => each - track.push[i]));
    Object.assign(track, { at: now, place, velocity, before: newer, push, steps: track.steps + 1 });
    if (Math.hypot(...velocity) > kFastest) track.steps = 0;
    if (track.steps < 3) return 0;
    const unexplained = FindUnexplained(push, gravity, body.isPlayer);
    const size = Math.hypot(...unexplained);
    if (size === 0) track.isArmed = true;
    if (size === 0 || growth < kSudden || !track.isArmed || now - track.last < kRest) return 0;
    const approach = (from: number[]) => -from.reduce((sum, each, i) => sum + (each * unexplained[i]) / size, 0);
    const speed = Math.max(approach(newer), approach(older));
    if (speed < kSlowest) return 0;
    track.last = now;
    track.isArmed = false;
    return speed;
  }
}

// What is left of an acceleration without what lies between free fall and rest, without noise and walking; m/s².
function FindUnexplained([x, y, z]: number[], gravity: number, isPlayer: boolean): number[] {
  const up = z - Math.max(Math.min(z, Math.max(gravity, 0)), Math.min(gravity, 0));
  const allowed = isPlayer ? kWalking : kNoise;
  const level = Math.hypot(x, y);
  const share = level > allowed ? 1 - allowed / level : 0;
  return [share * x, share * y, Math.sign(up) * Math.max(0, Math.abs(up) - kNoise)];
}
