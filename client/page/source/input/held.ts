// What is held, a key's code or an action's name. What was pressed since the last frame counts for this frame, although
// it was let go again: on a slow machine a frame lasts longer than a tap.
export class Held {
  private readonly m_held = new Set<string>();
  private readonly m_tapped = new Set<string>();

  Press(what: string): void {
    this.m_held.add(what);
    this.m_tapped.add(what);
  }

  Release(what: string): void {
    this.m_held.delete(what);
  }

  Clear(): void {
    this.m_held.clear();
    this.m_tapped.clear();
  }

  Has(what: string): boolean {
    return this.m_held.has(what) || this.m_tapped.has(what);
  }

  // Call when all have read what is held.
  EndFrame(): void {
    this.m_tapped.clear();
  }
}
