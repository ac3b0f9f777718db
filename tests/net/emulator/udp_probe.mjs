// Asks an echo over UDP, to measure a line: round trips and the share that is lost. Begins when the echo first answers.
//
//   node udp_probe.mjs echo PORT
//   node udp_probe.mjs ask HOST PORT COUNT
import dgram from 'node:dgram';

const [mode, ...words] = process.argv.slice(2);
const socket = dgram.createSocket('udp4');

const greeting = 0; // instead of the time of a question: its answer only says that the echo is there
const greetEvery = 20; // ms
const askEvery = 2; // ms
const lastAnswers = 1000; // ms that the last question's answer may take

if (mode === 'echo') {
  socket.on('message', (bytes, from) => socket.send(bytes, from.port, from.address));
  socket.bind(Number(words[0]));
} else {
  const [host, port, count] = [words[0], Number(words[1]), Number(words[2])];
  const trips = [];
  const send = (time) => {
    const bytes = Buffer.alloc(100);
    bytes.writeDoubleLE(time, 0);
    socket.send(bytes, port, host);
  };

  function report() {
    trips.sort((a, b) => a - b);
    console.log(JSON.stringify({ lost: 1 - trips.length / count, p50_ms: trips[Math.floor(trips.length / 2)] }));
    process.exit(0);
  }

  function measure() {
    let sent = 0;
    const timer = setInterval(() => {
      send(performance.now());
      if (++sent < count) return;
      clearInterval(timer);
      setTimeout(report, lastAnswers);
    }, askEvery);
  }

  let greetings = setInterval(() => send(greeting), greetEvery);
  socket.on('message', (bytes) => {
    const askedAt = bytes.readDoubleLE(0);
    if (askedAt !== greeting) trips.push(performance.now() - askedAt);
    else if (greetings !== null) {
      clearInterval(greetings);
      greetings = null;
      measure();
    }
  });
}
