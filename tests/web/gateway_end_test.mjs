// All ways to end: of the server and of the gateway, in order and by failure. The tests run at the same time, because
// they mostly wait.
import assert from 'node:assert';
import { after, before, describe } from 'node:test';

import { join, Player, serverMessages } from './support/player.mjs';
import { makePage, removePage, startGateway, startServer, test, waitFor } from './support/programs.mjs';

describe('endings', { concurrency: true }, () => {
  let page;
  before(() => (page = makePage({ 'index.html': '<!doctype html><title>wobble</title>' })));
  after(() => removePage(page));

  test('where no server answers, a browser is told', async () => {
    const lonely = await startGateway('127.0.0.1:9', page);
    const player = new Player(lonely.host);
    assert.equal(await player.opened, true);
    player.sayHello('mira');
    assert.deepEqual(await player.closed, { code: 1013, reason: 'the server does not answer' });
    await lonely.program.stop();
  });

  test('when the server ends, browsers are told', async () => {
    const mortal = await startServer();
    const through = await startGateway(mortal.address, page);
    const player = await join(through.host);
    await mortal.program.stop();
    assert.deepEqual(await player.closed, { code: 1000, reason: 'the server has ended the connection' });
    assert.ok(player.has(serverMessages.goodbye));
    await through.program.stop();
  });

  test('when the gateway ends, browsers and server are told', async () => {
    const own = await startServer();
    const through = await startGateway(own.address, page);
    const players = [await join(through.host), await join(through.host)];
    const begin = Date.now();
    assert.equal(await through.program.stop('SIGTERM'), 0);
    const seconds = (Date.now() - begin) / 1000;
    assert.ok(seconds < 2, `${seconds} s`);
    for (const player of players) {
      assert.deepEqual(await player.closed, { code: 1001, reason: 'the gateway is closing' });
    }
    await own.program.stop();
  });

  test('a gateway that is killed does not harm the server', async () => {
    const own = await startServer('--status', '0.2');
    const doomed = await startGateway(own.address, page);
    await Promise.all([join(doomed.host), join(doomed.host)]);
    await waitFor('two clients', () => own.countClients() === 2);
    assert.equal(await doomed.program.stop('SIGKILL'), 'SIGKILL');
    await waitFor('no clients', () => own.countClients() === 0); // after a silence of 8 s
    const next = await startGateway(own.address, page);
    const player = await join(next.host);
    await player.leave();
    await next.program.stop();
    assert.equal(await own.program.stop(), 0);
  });
});
