// What page_player.mjs does, by the page itself in Chromium: joins a gateway, walks in circles by key, and prints what
// it saw as one line of JSON. Pictures are drawn in software, so that frames are few; the link is the same.
//
//   node browser_player.mjs HOST:PORT SECONDS
import { openPage, startBrowser, waitForPlaying } from '../../web/support/browser.mjs';

const [host, seconds] = process.argv.slice(2);
const settledAfter = 3; // s of play after which the figures begin, as in page_player.mjs

const browser = await startBrowser();
const begin = performance.now();
const { tab, complaints } = await openPage(browser, host, { query: 'name=chromium&quality=4' });
await waitForPlaying(tab);
const joined = performance.now();
await tab.keyboard.down('KeyW');
await tab.keyboard.down('KeyD');
const seen = await tab.evaluate(
  ([seconds, settledAfter]) =>
    new Promise((resolve) => {
      const delays = [], ages = [], gaps = [], frames = [];
      const from = performance.now();
      let newest = { count: 0, at: from };
      let stallsBefore = null, stalls = 0, before = from, lowAfter = null;
      const watch = () => {
        const now = performance.now();
        const figures = window.wobble.statistics();
        if (lowAfter === null && figures.delay > 0 && figures.delay <= 0.12) lowAfter = now - from;
        const isSettled = now - from > 1000 * settledAfter;
        if (figures.snapshots !== newest.count) {
          if (isSettled && now - newest.at > 200) gaps.push(now - newest.at);
          newest = { count: figures.snapshots, at: now };
        }
        if (isSettled) {
          stallsBefore ??= figures.stalls;
          stalls = figures.stalls - stallsBefore;
          delays.push(1000 * figures.delay);
          ages.push(1000 * figures.snapshotAge);
          frames.push(now - before);
        }
        before = now;
        if (now - from < 1000 * seconds) requestAnimationFrame(watch);
        else resolve({ delays, ages, gaps, frames, stalls, lowAfter });
      };
      watch();
    }),
  [Number(seconds), settledAfter],
);
await browser.close();

const percentile = (values, share) => {
  const sorted = values.toSorted((a, b) => a - b);
  return Math.round(10 * (sorted[Math.floor(share * (sorted.length - 1))] ?? 0)) / 10;
};
const minutes = (Number(seconds) - settledAfter) / 60;
console.log(JSON.stringify({
  page_and_join_ms: Math.round(joined - begin), // loading of the page included
  low_delay_after_play_ms: Math.round(seen.lowAfter),
  display_delay_ms_p50: percentile(seen.delays, 0.5),
  display_delay_ms_p99: percentile(seen.delays, 0.99),
  snapshot_age_ms_p50: percentile(seen.ages, 0.5),
  stalls_per_minute: Math.round(seen.stalls / minutes),
  gaps_per_minute: Math.round((10 * seen.gaps.length) / minutes) / 10,
  frame_ms_p50: percentile(seen.frames, 0.5),
  complaints,
}));
