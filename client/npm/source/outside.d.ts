// The part of others' modules that node.ts uses.
declare module 'node:fs/promises' {
  export function readFile(path: URL): Promise<Uint8Array<ArrayBuffer>>;
}

declare module 'ws' {
  export const WebSocket: new (
    address: string,
    protocols: string[],
    options: { perMessageDeflate: boolean },
  ) => import('./runtime.js').Socket & { binaryType: string };
}
