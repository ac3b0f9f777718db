// From nothing to a running page: the WebAssembly, the connection, and one frame after another.
import createModule from 'wobble-wasm';
import { App } from './app';
import { MakeElement } from './hud/element';
import { FetchWorlds } from './worlds';

async function Start(): Promise<void> {
  const [module, worlds] = await Promise.all([createModule(), FetchWorlds()]);
  const app = new App(module, worlds);
  app.Start();
}

Start().catch((error: unknown) => {
  console.error(error);
  const veil = MakeElement('div', 'veil');
  const card = MakeElement('div', 'card');
  const reason = error instanceof Error ? error.message : String(error);
  card.append(MakeElement('h1', '', 'This browser cannot show it'), MakeElement('p', '', reason));
  card.append(MakeElement('p', '', 'wobble needs WebAssembly and WebGL 2.'));
  veil.append(card);
  document.body.append(veil);
});
