// Plays as the page does, by the package that it is made from, under Node, without a picture: joins a gateway, moves,
// takes a frame 60 times a second, and prints what it saw as one line of JSON.
//
//   node page_player.mjs PACKAGE_FOLDER HOST:PORT SECONDS [ARRIVALS [one]]
//
// ARRIVALS: a file for the arrivals of snapshots, a line each: ms since the first, tick. one: over one socket.
import { Buffer } from 'node:buffer';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [packageFolder, host, seconds, arrivalsFile, sockets] = process.argv.slice(2);
const { WebSocket } = createRequire(new URL('../../../client/page/package.json', import.meta.url))('ws');
globalThis.WebSocket = class extends WebSocket {
  constructor(url, protocols) {
    super(url, protocols, { perMessageDeflate: false, family: 4 });
  }
};
const { Connection, loadRuntime } = await import(pathToFileURL(path.join(packageFolder, 'dist/node.js')).href);

const percentile = (values, share) => values[Math.min(values.length - 1, Math.floor(share * values.length))] ?? null;
const readNow = () => performance.now() / 1000;

const playing = 2; // of State
const snapshotChannel = 2;
const tickAt = 7; // byte of a message with a snapshot: behind channel, kind, version and sequence
const settledAfter = 3; // s of play after which the figures begin
const gapFrom = 0.2; // s without a newer snapshot
const frame = 1000 / 60; // ms

const connection = new Connection(await loadRuntime(), { url: `http://${host}`, name: 'page' });
const begin = readNow();
const seen = { delays: [], ages: [], gaps: [], drops: 0, join: null, lowAfter: null, leastEcho: Infinity, stallsBefore: null, stalls: 0 };
let newest = { count: 0, at: begin };
// s, of one call that goes on with bases, for which a browser's frame waits: before play, when there is no picture and
// the browser has not optimised the code, and in play.
let longestJoining = 0;
let longestCompleting = 0;
const update = connection.update.bind(connection);
connection.update = () => {
  const isCompleting = connection.client?.isCompleting();
  const from = readNow();
  update();
  const taken = readNow() - from;
  if (seen.join === null) longestJoining = Math.max(longestJoining, taken);
  else if (isCompleting) longestCompleting = Math.max(longestCompleting, taken);
};
if (sockets === 'one') connection.openLanes = () => {};
const arrivals = [];
connection.onClient = (client) => {
  const receive = client.receiveMessage.bind(client);
  client.receiveMessage = (message) => {
    if (message[0] === snapshotChannel) arrivals.push([readNow(), Buffer.from(message).readUInt32LE(tickAt)]);
    receive(message);
  };
};
connection.join();

function takeFrame() {
  const now = readNow();
  connection.update();
  const client = connection.client;
  if (client === null || connection.end !== null) {
    if (connection.end !== null && seen.join !== null) seen.drops += 1;
    return;
  }
  if (client.readState() !== playing) return;
  seen.join ??= now - begin;
  const turn = now * 1.5;
  client.setInput({ moveX: Math.cos(turn), moveY: Math.sin(turn) });
  client.sample();
  const figures = client.readStatistics();
  if (figures.snapshots !== newest.count) {
    if (now - newest.at >= gapFrom && newest.count > 0 && now - begin - seen.join > settledAfter)
      seen.gaps.push(now - newest.at);
    newest = { count: figures.snapshots, at: now };
  }
  if (figures.inputToSnapshot > 0) seen.leastEcho = Math.min(seen.leastEcho, figures.inputToSnapshot);
  if (seen.lowAfter === null && figures.delay > 0 && figures.delay <= 0.12) seen.lowAfter = now - begin;
  if (now - begin - seen.join > settledAfter) {
    seen.stallsBefore ??= figures.stalls;
    seen.stalls = figures.stalls - seen.stallsBefore;
    seen.delays.push(figures.delay);
    seen.ages.push(figures.snapshotAge);
  }
}

const timer = setInterval(takeFrame, frame);
setTimeout(() => {
  clearInterval(timer);
  const ms = (value) => (value === null ? null : Math.round(1e4 * value) / 10);
  for (const each of [seen.delays, seen.ages, seen.gaps]) each.sort((a, b) => a - b);
  const minutes = Math.max(1 / 60, (Number(seconds) - settledAfter) / 60);
  console.log(JSON.stringify({
    join_ms: ms(seen.join),
    low_delay_after_ms: ms(seen.lowAfter),
    display_delay_ms_p50: ms(percentile(seen.delays, 0.5)),
    display_delay_ms_p99: ms(percentile(seen.delays, 0.99)),
    snapshot_age_ms_p50: ms(percentile(seen.ages, 0.5)),
    least_input_to_snapshot_ms: ms(seen.leastEcho),
    stalls_per_minute: Math.round((10 * seen.stalls) / minutes) / 10,
    gaps_per_minute: Math.round((10 * seen.gaps.length) / minutes) / 10,
    longest_gap_ms: ms(seen.gaps.at(-1) ?? 0),
    longest_joining_ms: ms(longestJoining),
    longest_completing_ms: ms(longestCompleting),
    connections_lost: seen.drops,
  }));
  if (arrivalsFile !== undefined) {
    const lines = arrivals.map(([at, tick]) => `${(1000 * (at - arrivals[0][0])).toFixed(1)} ${tick}\n`);
    fs.writeFileSync(arrivalsFile, lines.join(''));
  }
  connection.leave();
  setTimeout(() => process.exit(seen.delays.length > 0 ? 0 : 1), 200);
}, 1000 * Number(seconds));
