// The worlds and recordings behind this gateway, and the one of them that the page's address names.

export interface Recording {
  file: string; // its name, by which it is joined like a world
  scene: string; // empty: it cannot be read
  seconds: number;
  writtenAt: number; // s since 1970
  fault?: string; // why it cannot be shown
  damage?: string; // why it may be shown in part
}

// A world of another gateway.
export interface Elsewhere {
  name: string;
  page: string; // http or https
  scene: string; // empty: not said
}

export interface Offer {
  worlds: string[]; // names; empty: there is one world, without a name
  recordings: Recording[] | null; // null: this gateway shows none
  elsewhere: Elsewhere[];
  addresses: string[]; // of the gateway's machine in its network; told to that machine alone
}

const kMostElsewhere = 50;
const kNothing: Offer = { worlds: [], recordings: null, elsewhere: [], addresses: [] };

// Suggestions for newcomers; only for the worlds that we ship.
const kPurposes: Record<string, string> = {
  arena: 'Roll, jump, throw balls and friends about',
  sumo: 'Push the others off the platform',
  goals: 'Two sides, one big soft ball',
  crown: 'Grab the crown and keep it',
  curtain: 'Grab it, cut it, jump through it',
  sandbox: 'Build with particles and springs, together',
};

export function FindPurpose(world: string): string {
  return kPurposes[world] ?? '';
}

export async function FetchOffer(): Promise<Offer> {
  try {
    const answer = await fetch('/worlds');
    if (!answer.ok) return kNothing;
    const { worlds, recordings, elsewhere, addresses } = (await answer.json()) as Record<keyof Offer, unknown>;
    return {
      worlds: TakeArray(worlds).filter(IsText),
      recordings: Array.isArray(recordings) ? recordings.filter(IsRecording) : null,
      elsewhere: TakeArray(elsewhere).filter(IsElsewhere).slice(0, kMostElsewhere),
      addresses: TakeArray(addresses).filter(IsText),
    };
  } catch {
    return kNothing; // A proxy that passes on /play only still serves that one world.
  }
}

function TakeArray(value: unknown): unknown[] {
  return Array.isArray(value) ? value : [];
}

function IsText(value: unknown): value is string {
  return typeof value === 'string';
}

// What becomes a link must be a page: a browser would run the code of javascript:.
function IsElsewhere(value: unknown): value is Elsewhere {
  const { name, page, scene } = (value ?? {}) as Partial<Elsewhere>;
  return [name, page, scene].every(IsText) && /^https?:\/\/[^/]/.test(page!);
}

function IsRecording(value: unknown): value is Recording {
  const { file, scene, seconds, writtenAt } = (value ?? {}) as Partial<Recording>;
  return [file, scene].every((each) => typeof each === 'string') && [seconds, writtenAt].every(Number.isFinite);
}

// The world or recording that the address names, or the first world; empty: the gateway's choice. null: the address
// names one that is not there. A recording that is not listed may be an old one: whether it is there the gateway says.
export function ReadWorld({ worlds, recordings }: Offer): string | null {
  const asked = ReadAskedWorld();
  if (worlds.includes(asked) || (recordings !== null && asked.endsWith('.wobrec'))) return asked;
  return asked === '' || worlds.length === 0 ? (worlds[0] ?? '') : null;
}

export function ReadAskedWorld(): string {
  return new URLSearchParams(location.search).get('world') ?? '';
}

// As it is shown: minutes and seconds.
export function FormatTime(time: number): string {
  return `${Math.floor(time / 60)}:${String(Math.floor(time % 60)).padStart(2, '0')}`;
}

// Writes the world into the page's address, so that the address leads to the same world.
export function KeepWorld(world: string): void {
  const address = new URL(location.href);
  address.searchParams.set('world', world);
  history.replaceState(null, '', address);
}
