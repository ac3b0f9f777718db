// What the browser keeps for this page. Storage may be full, forbidden or broken: then nothing is kept, and the page
// goes on without it.

// null: nothing is kept.
export function ReadKept(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

export function Keep(key: string, text: string): void {
  try {
    localStorage.setItem(key, text);
  } catch {
    // It is not kept.
  }
}
