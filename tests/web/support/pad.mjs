// A gamepad that the page's browser seems to have: for onTab of openPage.
export const addPad = (tab) =>
  tab.addInitScript(() => {
    const pad = {
      id: 'test',
      index: 0,
      connected: false,
      mapping: 'standard',
      axes: [0, 0, 0, 0],
      buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })),
    };
    window.pad = pad;
    navigator.getGamepads = () => [pad, null, null, null];
  });

// axes: of both sticks. buttons: numbers of those that are held.
export const hold = (tab, axes, ...buttons) =>
  tab.evaluate(
    ([axes, buttons]) => {
      window.pad.connected = true;
      window.pad.axes = axes;
      window.pad.buttons = window.pad.buttons.map((_, i) => {
        const pressed = buttons.includes(i);
        return { pressed, touched: pressed, value: pressed ? 1 : 0 };
      });
    },
    [axes, buttons],
  );

// Presses a button for two frames of the page at least, and lets it go for as many.
export async function press(tab, button) {
  for (const buttons of [[button], []]) {
    await hold(tab, [0, 0, 0, 0], ...buttons);
    for (let frame = 0; frame < 3; ++frame) await tab.evaluate(() => new Promise(requestAnimationFrame));
  }
}
