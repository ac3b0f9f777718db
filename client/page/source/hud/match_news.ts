// What happened in a game of goals or crown, in words.
import { EventKind, type WorldEvent } from 'wobble-client';
import type { Players } from '../players';

// Empty: it is no such event.
export function DescribeMatchEvent(event: WorldEvent, players: Players): string {
  const isOwn = event.clientId !== 0 && event.clientId === players.ownClient;
  const name = isOwn ? 'You' : players.FindName(event.clientId);
  if (event.kind === EventKind.Crown) return `${name} ${isOwn ? 'have' : 'has'} the crown`;
  if (event.kind !== EventKind.Goal) return '';
  return event.clientId === 0 ? 'Own goal!' : `Goal by ${isOwn ? 'you' : name}!`;
}
