// What happens to players, in words.
import { EventKind, type WorldEvent } from 'wobble-client';
import type { Players } from './players';

// Before the players note the event. isEarly: join events also arrive for players who were there before. null: no news.
export function DescribeEvent(event: WorldEvent, players: Players, isEarly: boolean): string | null {
  const isOwn = event.clientId === players.ownClient;
  switch (event.kind) {
    case EventKind.Join: {
      const isNew = !players.all.has(event.clientId) && !isOwn;
      return isNew && !isEarly ? `${event.name} joined` : null;
    }
    case EventKind.Leave:
      return `${players.FindName(event.clientId)} left`;
    case EventKind.Fall:
      return DescribeFall(event, players);
    case EventKind.Rename:
      return isOwn ? null : `${players.FindName(event.clientId)} is ${event.name} now`;
    case EventKind.Goal:
      return event.clientId === 0 ? 'Own goal!' : `Goal by ${isOwn ? 'you' : players.FindName(event.clientId)}!`;
    case EventKind.Crown:
      return isOwn ? 'You have the crown' : `${players.FindName(event.clientId)} has the crown`;
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
