// Whether the gateway serves another page by now: then this one may not understand its server any more. A browser does
// not tell a page why a WebSocket was refused.

// null: nobody answers.
export async function FindIsOld(): Promise<boolean | null> {
  const script = document.querySelector<HTMLScriptElement>('script[type=module]')?.getAttribute('src') ?? '';
  try {
    const answer = await fetch(location.pathname, { cache: 'no-store' });
    return answer.ok ? script !== '' && !(await answer.text()).includes(`"${script}"`) : null;
  } catch {
    return null;
  }
}
