// Makes a name for a player without one, and keeps it in the browser's storage.
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
  try {
    const kept = localStorage.getItem(kKey);
    if (kept !== null && kept !== '') return kept;
  } catch {
    // Without storage the player gets a new name each time.
  }
  const name = `${Choose(kFirst)} ${Choose(kSecond)}`;
  KeepName(name);
  return name;
}

export function KeepName(name: string): void {
  try {
    localStorage.setItem(kKey, name);
  } catch {
    // Without storage the name is not kept.
  }
}
