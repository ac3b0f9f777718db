// Colours of bodies, each always the same: bright ones of players, softer ones of what lies about.
import { Color } from 'three';

const kOwnColour = '#ff7a1a';
// Side by side in number, far apart in hue; none like the own.
const kSceneColours = ['#6ec6ca', '#f2b6c6', '#b7a6e6', '#f5d77a', '#8fd19e', '#8fb8ea', '#f0a58f', '#cfe08a'];
const kLightness = [0.56, 0.7, 0.44];
const kGoldenRatio = 0.61803398875;

export function MakeOwnColour(): Color {
  return new Color(kOwnColour);
}

// Hues that follow each other by the golden ratio lie apart whatever numbers come; red to orange is left out. Five
// numbers on they come near again, so lightness goes round by three.
export function MakePlayerColour(body: number): Color {
  const turn = (body * kGoldenRatio) % 1;
  return new Color().setHSL((0.2 + 0.72 * turn) % 1, 0.72, kLightness[body % kLightness.length]);
}

export function MakeSceneColour(body: number): Color {
  return new Color(kSceneColours[body % kSceneColours.length]);
}
