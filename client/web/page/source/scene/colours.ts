// Colours of bodies, each always the same: bright ones of players, softer ones of what lies about.
import { Color } from 'three';

const kOwnColour = '#ff7a1a';
// Side by side in number, far apart in hue; none like the own.
const kSceneColours = ['#6ec6ca', '#f2b6c6', '#b7a6e6', '#f5d77a', '#8fd19e', '#8fb8ea', '#f0a58f', '#cfe08a'];
const kGoldenRatio = 0.61803398875;

export function MakeOwnColour(): Color {
  return new Color(kOwnColour);
}

// Hues that follow each other by the golden ratio lie apart whatever numbers come; red to orange is left out.
export function MakePlayerColour(body: number): Color {
  const turn = (body * kGoldenRatio) % 1;
  return new Color().setHSL((0.2 + 0.72 * turn) % 1, 0.72, 0.56);
}

export function MakeSceneColour(body: number): Color {
  return new Color(kSceneColours[body % kSceneColours.length]);
}
