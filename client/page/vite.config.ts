// The folder with wobble.mjs and wobble.wasm, and the folder to build into, come from CMake (client/page/CMakeLists.txt).
// The page is made from the sources of the package wobble-client, which is built beside it.
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vite';

const wasmFolder = process.env.WOBBLE_WASM_FOLDER ?? '../../../build/release/wasm';
const pageFolder = process.env.WOBBLE_PAGE_FOLDER ?? '../../../build/release/bin/page';

export default defineConfig({
  base: './',
  resolve: {
    alias: [
      { find: 'wobble-client', replacement: fileURLToPath(new URL('../npm/source/browser.ts', import.meta.url)) },
      { find: /^\.\/wobble\.mjs$/, replacement: `${wasmFolder}/wobble.mjs` },
    ],
  },
  server: { fs: { strict: false } },
  build: {
    outDir: pageFolder,
    emptyOutDir: true,
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: 0,
    reportCompressedSize: false,
    chunkSizeWarningLimit: 2000,
  },
});
