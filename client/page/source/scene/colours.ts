// Colours of bodies, constant for each number: bright ones for players, softer ones for the scene's bodies.
import { Color } from 'three';

const kOwnColour = '#ff7a1a';
// Neighbours in the list have distant hues; none resembles the player's own colour.
const kSceneColours = ['#6ec6ca', '#f2b6c6', '#b7a6e6', '#f5d77a', '#8fd19e', '#8fb8ea', '#f0a58f', '#cfe08a'];
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
