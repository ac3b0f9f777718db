// Makes a name for a player without one, and keeps it in the browser's storage.
import { Keep, ReadKept } from './storage';

const kFirst = [
  'Merry',
  'Jolly',
  'Sunny',
  'Brave',
  'Dizzy',
  'Happy',
  'Lucky',
  'Misty',
  'Quick',
  'Sleepy',
  'Silly',
  'Witty',
];
const kSecond = [
  'Pudding',
  'Jelly',
  'Dumpling',
  'Bubble',
  'Plum',
  'Muffin',
  'Pebble',
  'Truffle',
  'Noodle',
  'Custard',
  'Biscuit',
  'Berry',
];
const kKey = 'wobble.name';

function Choose(from: string[]): string {
  return from[Math.floor(Math.random() * from.length)];
}

export function ReadName(): string {
  const asked = new URLSearchParams(location.search).get('name');
  if (asked !== null && asked !== '') return asked;
  const kept = ReadKept(kKey);
  if (kept !== null && kept !== '') return kept;
  const name = `${Choose(kFirst)} ${Choose(kSecond)}`;
  KeepName(name);
  return name;
}

export function KeepName(name: string): void {
  Keep(kKey, name);
}
