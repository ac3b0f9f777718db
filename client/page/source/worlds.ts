// The worlds behind this gateway, and which of them the address asks for.

// What a newcomer may want to do there; of worlds that are not ours nothing is known.
const kPurposes: Record<string, string> = {
  arena: 'Roll, jump, throw balls and friends about',
  sumo: 'Push the others off the platform',
  curtain: 'Grab it, cut it, jump through it',
  sandbox: 'Build with particles and springs, together',
};

export function FindPurpose(world: string): string {
  return kPurposes[world] ?? '';
}

// Empty where there is only one, without a name.
export async function FetchWorlds(): Promise<string[]> {
  try {
    const answer = await fetch('/worlds');
    if (!answer.ok) return [];
    const { worlds } = (await answer.json()) as { worlds?: unknown };
    return Array.isArray(worlds) ? worlds.filter((name) => typeof name === 'string') : [];
  } catch {
    return []; // a proxy that passes on /play alone: there is still that world
  }
}

// The one that the address names, or the first; empty: whatever the gateway has.
export function ReadWorld(worlds: readonly string[]): string {
  const asked = new URLSearchParams(location.search).get('world');
  return asked !== null && worlds.includes(asked) ? asked : (worlds[0] ?? '');
}

// So that the address, sent to a friend, leads to the same world.
export function KeepWorld(world: string): void {
  const address = new URL(location.href);
  address.searchParams.set('world', world);
  history.replaceState(null, '', address);
}
