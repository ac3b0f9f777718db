// Keeps downloaded blueprints in the browser (IndexedDB), so that who comes back to a world downloads none. What
// client/files/kept_folder.h does for programs.
//
// A world is named by the address at which it is joined, and the blueprints of each are kept apart: a hash is no
// defence against forgery, and a hostile server can so spoil only its own. Without storage, as in a private window and
// in Node, they are kept while the connection lives.
import type { Download } from './views.js';

// As protocol/limits.h has them, for one world.
const kMaxKept = 64;
const kMaxKeptBytes = 4 * 1024 * 1024;
const kMaxKeptOfAll = 256; // of all worlds
const kPatience = 500; // ms; a slower storage does not delay the join any longer
const kStore = 'blueprints';
const kTimes = 'times';

interface Entry extends Download {
  world: string;
  time: number; // when it came, ms
}

export class KeptBlueprints {
  private readonly m_worlds = new Map<string, Entry[]>(); // the newest first
  private readonly m_database = openDatabase();

  // The newest first, within the limits. Never fails.
  async load(world: string): Promise<Uint8Array[]> {
    if (!this.m_worlds.has(world)) {
      const late = new Promise<Entry[]>((resolve) => setTimeout(() => resolve([]), kPatience));
      const found = await Promise.race([this.readEntries(world), late]);
      // What was downloaded meanwhile stays.
      if (!this.m_worlds.has(world)) this.m_worlds.set(world, found);
      this.trim(world);
    }
    return this.m_worlds.get(world)!.map((entry) => entry.bytes);
  }

  keep(world: string, download: Download): void {
    const entry: Entry = { ...download, world, time: Date.now() };
    const others = (this.m_worlds.get(world) ?? []).filter((each) => each.hash !== entry.hash);
    this.m_worlds.set(world, [entry, ...others]);
    void this.write((store) => {
      store.put(entry);
      removeOldest(store);
    });
    this.trim(world);
  }

  // Forgets the oldest ones of a world beyond the limits.
  private trim(world: string): void {
    const entries = this.m_worlds.get(world)!;
    let bytes = 0;
    const count = entries.findIndex((entry, i) => (bytes += entry.bytes.length) > kMaxKeptBytes || i === kMaxKept);
    if (count < 0) return;
    const dropped = entries.splice(count);
    void this.write((store) => dropped.forEach((entry) => store.delete([entry.world, entry.hash])));
  }

  // Only the next visit misses what cannot be read or written: it downloads it.
  private async readEntries(world: string): Promise<Entry[]> {
    try {
      const store = (await this.m_database)?.transaction(kStore).objectStore(kStore);
      if (store === undefined) return [];
      const entries: Entry[] = (await finish(store.getAll(IDBKeyRange.bound([world], [world, []])))) ?? [];
      return entries.sort((a, b) => b.time - a.time);
    } catch {
      return [];
    }
  }

  private async write(change: (store: IDBObjectStore) => void): Promise<void> {
    try {
      const store = (await this.m_database)?.transaction(kStore, 'readwrite').objectStore(kStore);
      if (store !== undefined) change(store);
    } catch {
      // As above.
    }
  }
}

// null: there is no storage.
async function openDatabase(): Promise<IDBDatabase | null> {
  try {
    const request = indexedDB.open('wobble', 1);
    request.onupgradeneeded = () => {
      const store = request.result.createObjectStore(kStore, { keyPath: ['world', 'hash'] });
      store.createIndex(kTimes, 'time');
    };
    return await finish(request);
  } catch {
    return null;
  }
}

// null: it failed.
function finish<Result>(request: IDBRequest<Result>): Promise<Result | null> {
  return new Promise((resolve) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => resolve(null);
  });
}

function removeOldest(store: IDBObjectStore): void {
  const count = store.count();
  count.onsuccess = () => {
    let left = count.result - kMaxKeptOfAll;
    if (left <= 0) return;
    const cursor = store.index(kTimes).openKeyCursor();
    cursor.onsuccess = () => {
      if (cursor.result === null || left-- <= 0) return;
      store.delete(cursor.result.primaryKey);
      cursor.result.continue();
    };
  };
}
