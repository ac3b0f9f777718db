// Starts the page: loads the WebAssembly, builds the app, and runs one frame after another.
import { loadRuntime } from 'wobble-client';
import { App } from './app';
import { MakeElement } from './hud/element';
import { FetchOffer } from './worlds';

async function Start(): Promise<void> {
  const [runtime, offer] = await Promise.all([loadRuntime(), FetchOffer()]);
  const app = new App(runtime, offer);
  app.Start();
}

Start().catch((error: unknown) => {
  console.error(error);
  const veil = MakeElement('div', 'veil');
  const card = MakeElement('div', 'card');
  const reason = error instanceof Error ? error.message : String(error);
  card.append(MakeElement('h1', '', 'This browser cannot run wobble'), MakeElement('p', '', reason));
  card.append(MakeElement('p', '', 'wobble needs WebAssembly and WebGL 2.'));
  veil.append(card);
  document.body.append(veil);
});
