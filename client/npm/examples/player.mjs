// Plays for ten seconds: connects, rolls its own ball in a circle and prints where the ball is.
//   node player.mjs [URL [SECONDS]]
import { connect } from 'wobble-client';

const [url = 'ws://localhost:8080', seconds = '10'] = process.argv.slice(2);
const player = await connect({ url, name: 'example' }); // throws if it does not get in, with the reason

let frame = 0;
const timer = setInterval(() => {
  player.update(); // receives, answers and sends
  const world = player.playing; // null while it is cut off; it comes back by itself
  if (world === null) return;
  const angle = 0.03 * ++frame;
  world.setInput({ moveX: Math.cos(angle), moveY: Math.sin(angle) }); // along the world's x and y, each -1 to 1
  world.sample(); // all bodies as they are to be drawn
  const { x, y, z } = world.findBody(world.readWelcome().ownBody) ?? {};
  if (z !== undefined && frame % 30 === 0) console.log(`x ${x.toFixed(2)}  y ${y.toFixed(2)}  z ${z.toFixed(2)}`);
}, 16);
setTimeout(() => (clearInterval(timer), player.leave()), 1000 * seconds);
