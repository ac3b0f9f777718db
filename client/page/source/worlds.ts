// The worlds behind this gateway, and the one that the page's address names.

// Suggestions for newcomers; only for the worlds that we ship.
const kPurposes: Record<string, string> = {
  arena: 'Roll, jump, throw balls and friends about',
  sumo: 'Push the others off the platform',
  curtain: 'Grab it, cut it, jump through it',
  sandbox: 'Build with particles and springs, together',
};

export function FindPurpose(world: string): string {
  return kPurposes[world] ?? '';
}

// Empty when there is only one world, without a name.
export async function FetchWorlds(): Promise<string[]> {
  try {
    const answer = await fetch('/worlds');
    if (!answer.ok) return [];
    const { worlds } = (await answer.json()) as { worlds?: unknown };
    return Array.isArray(worlds) ? worlds.filter((name) => typeof name === 'string') : [];
  } catch {
    return []; // A proxy that passes on /play only still serves that one world.
  }
}

// The world that the address names, or the first; empty: the gateway's choice.
export function ReadWorld(worlds: readonly string[]): string {
  const asked = new URLSearchParams(location.search).get('world');
  return asked !== null && worlds.includes(asked) ? asked : (worlds[0] ?? '');
}

// Writes the world into the page's address, so that the address leads to the same world.
export function KeepWorld(world: string): void {
  const address = new URL(location.href);
  address.searchParams.set('world', world);
  history.replaceState(null, '', address);
}
