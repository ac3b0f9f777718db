// The secret in the address's fragment, by which a link lets its visitor in.
import type { Credential } from 'wobble-client';

// Takes it out of the address, so that it is not passed on with it or kept in the history. null: there is none.
export function TakeFragment(): Credential | null {
  const [, kind, secret] = /^#(invite|token|owner)=([\w-]+)$/.exec(location.hash) ?? [];
  if (kind === undefined || secret === undefined) return null;
  history.replaceState(null, '', location.pathname + location.search);
  return kind === 'owner' ? { ownerKey: secret } : { [kind]: secret };
}
