// What happens to players, in words.
import { EventKind, type WorldEvent } from 'wobble-client';
import type { Players } from './players';

// Before the players note the event. isEarly: join events also arrive for players who were there before. null: no news.
export function DescribeEvent(event: WorldEvent, players: Players, isEarly: boolean): string | null {
  switch (event.kind) {
    case EventKind.Join: {
      const isNew = !players.all.has(event.clientId) && event.clientId !== players.ownClient;
      return isNew && !isEarly ? `${event.name} joined` : null;
    }
    case EventKind.Leave:
      return `${players.FindName(event.clientId)} left`;
    case EventKind.Fall:
      return DescribeFall(event, players);
    default:
      return null;
  }
}

function DescribeFall(event: WorldEvent, players: Players): string {
  const isOwn = event.body !== 0 && event.body === players.ownBody;
  const name = players.FindByBody(event.body)?.name ?? event.name;
  if (event.clientId === 0) return isOwn ? 'You fell off' : `${name} fell off`;
  if (event.clientId === players.ownClient) return `You pushed ${name} off`;
  const pusher = players.FindName(event.clientId);
  return isOwn ? `${pusher} pushed you off` : `${pusher} pushed ${name} off`;
}
