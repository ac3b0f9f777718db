// Pixels of a PNG as a browser takes it: eight bits a channel, not interlaced.
import zlib from 'node:zlib';

const kSignatureBytes = 8;

// { width, height, channels, pixels }, row by row.
export function readPicture(png) {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  const parts = [];
  let width = 0,
    height = 0,
    channels = 0;
  for (let at = kSignatureBytes; at < png.length; at += 12 + view.getUint32(at)) {
    const size = view.getUint32(at);
    const type = png.toString('latin1', at + 4, at + 8);
    if (type === 'IHDR') {
      width = view.getUint32(at + 8);
      height = view.getUint32(at + 12);
      channels = png[at + 17] === 6 ? 4 : 3;
    }
    if (type === 'IDAT') parts.push(png.subarray(at + 8, at + 8 + size));
  }
  return {
    width,
    height,
    channels,
    pixels: undoFilters(zlib.inflateSync(Buffer.concat(parts)), width, height, channels),
  };
}

// Each row begins with a byte that says by what it was predicted: left, above, both, or Paeth's choice.
function undoFilters(packed, width, height, channels) {
  const stride = width * channels;
  const pixels = Buffer.alloc(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = packed[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const at = y * stride + x;
      const left = x >= channels ? pixels[at - channels] : 0;
      const above = y > 0 ? pixels[at - stride] : 0;
      const corner = x >= channels && y > 0 ? pixels[at - stride - channels] : 0;
      const guesses = [0, left, above, (left + above) >> 1, choosePaeth(left, above, corner)];
      pixels[at] = packed[y * (stride + 1) + 1 + x] + guesses[filter];
    }
  }
  return pixels;
}

function choosePaeth(left, above, corner) {
  const guess = left + above - corner;
  const [a, b, c] = [left, above, corner].map((value) => Math.abs(guess - value));
  return a <= b && a <= c ? left : b <= c ? above : corner;
}

// Share of the pixels in the middle third of both that differ by more than noise.
export function findDifference(a, b) {
  let count = 0,
    different = 0;
  for (let y = Math.floor(a.height / 3); y < (2 * a.height) / 3; ++y) {
    for (let x = Math.floor(a.width / 3); x < (2 * a.width) / 3; ++x) {
      const at = (y * a.width + x) * a.channels;
      const away = [0, 1, 2].map((i) => Math.abs(a.pixels[at + i] - b.pixels[at + i]));
      count += 1;
      if (Math.max(...away) > 24) different += 1;
    }
  }
  return different / count;
}
