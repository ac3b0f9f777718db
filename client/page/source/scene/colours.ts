// Colours of bodies, constant for each number: bright ones for players, softer ones for the scene's bodies.
import { Color } from 'three';
import type { Players } from '../players';

const kOwnColour = '#ff7a1a';
// Neighbours in the list have distant hues; none resembles the player's own colour.
const kSceneColours = ['#6ec6ca', '#f2b6c6', '#b7a6e6', '#f5d77a', '#8fd19e', '#8fb8ea', '#f0a58f', '#cfe08a'];
// Of sides 1 and 2 of a game; told apart by those who see no red or no green, too.
export const kSideNames = ['', 'Blue', 'Red'];
const kSideColours = ['', '#2f7df0', '#ef4a63'];
const kOwnLighter = 0.1; // the own body among those of its side
const kObjectColours: Record<string, string> = { goals: '#f7f4ea', crown: '#ffc53d' };
const kLightness = [0.56, 0.7, 0.44];
const kGoldenRatio = 0.61803398875;

export function MakeOwnColour(): Color {
  return new Color(kOwnColour);
}

// Hues in steps of the golden ratio lie apart for any set of numbers; red to orange is left out. Every fifth hue is
// close again, so lightness cycles through three values.
export function MakePlayerColour(body: number): Color {
  const turn = (body * kGoldenRatio) % 1;
  return new Color().setHSL((0.2 + 0.72 * turn) % 1, 0.72, kLightness[body % kLightness.length]);
}

export function MakeSceneColour(body: number): Color {
  return new Color(kSceneColours[body % kSceneColours.length]);
}

export function MakeSideColour(side: number): Color {
  return new Color(kSideColours[side]);
}

// Of a body, as the game and its player have it.
export function MakeBodyColour(players: Players, body: number): Color {
  if (body !== 0 && body === players.object) return new Color(kObjectColours[players.game] ?? '#ffffff');
  const isOwn = body !== 0 && body === players.ownBody;
  const side = players.FindSide(body);
  if (side !== 0) return isOwn ? MakeSideColour(side).offsetHSL(0, 0, kOwnLighter) : MakeSideColour(side);
  if (isOwn) return MakeOwnColour();
  return players.IsPlayer(body) ? MakePlayerColour(body) : MakeSceneColour(body);
}
