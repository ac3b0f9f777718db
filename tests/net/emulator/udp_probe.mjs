// Asks an echo over UDP, to measure a line: round trips and the share that is lost.
//
//   node udp_probe.mjs echo PORT
//   node udp_probe.mjs ask HOST PORT COUNT
import dgram from 'node:dgram';

const [mode, ...words] = process.argv.slice(2);
const socket = dgram.createSocket('udp4');

if (mode === 'echo') {
  socket.on('message', (bytes, from) => socket.send(bytes, from.port, from.address));
  socket.bind(Number(words[0]));
} else {
  const [host, port, count] = [words[0], Number(words[1]), Number(words[2])];
  const trips = [];
  socket.on('message', (bytes) => trips.push(performance.now() - bytes.readDoubleLE(0)));
  let sent = 0;
  const timer = setInterval(() => {
    const bytes = Buffer.alloc(100);
    bytes.writeDoubleLE(performance.now(), 0);
    socket.send(bytes, port, host);
    if (++sent < count) return;
    clearInterval(timer);
    setTimeout(() => {
      trips.sort((a, b) => a - b);
      console.log(JSON.stringify({ lost: 1 - trips.length / count, p50_ms: trips[Math.floor(trips.length / 2)] }));
      process.exit(0);
    }, 1000);
  }, 2);
}
