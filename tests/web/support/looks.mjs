// What a page looks like, in numbers: places and sizes of what is shown, and how well its text can be read.

// Boxes of the visible elements, in pixels: [{ name, x, y, width, height }].
export const findBoxes = (tab, selector) =>
  tab.locator(selector).evaluateAll((elements) =>
    elements
      .filter((element) => element.checkVisibility({ visibilityProperty: true, opacityProperty: true }))
      .map((element) => {
        const { x, y, width, height } = element.getBoundingClientRect();
        const name = element.getAttribute('aria-label') ?? element.textContent.trim().slice(0, 30);
        return { name: `${element.tagName.toLowerCase()} ${name}`, x, y, width, height };
      }),
  );

export function overlap(a, b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

// Texts whose contrast with what is behind them is below 4.5 (WCAG 2.1, 1.4.3), at worst: above a world that is all
// white, and one that is all black. Text above the bare world counts as unreadable.
export const findPoorTexts = (tab) =>
  tab.evaluate(() => {
    const parse = (colour) => {
      const [r, g, b, a = 1] = colour.match(/[\d.]+/g).map(Number); // computed: rgb() or rgba()
      return [r, g, b, a];
    };
    const blend = ([r, g, b, a], [R, G, B]) => [r * a + R * (1 - a), g * a + G * (1 - a), b * a + B * (1 - a)];
    const light = (colour) => {
      const [r, g, b] = colour.map((each) => {
        const value = each / 255;
        return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
      });
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const poor = [];
    const walker = document.createTreeWalker(document.querySelector('main'), NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node !== null; node = walker.nextNode()) {
      const element = node.parentElement;
      if (node.textContent.trim() === '' || element.closest('option, script') !== null) continue;
      if (!element.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
      if (element.closest(':disabled') !== null) continue; // as WCAG has it
      const { width, height } = element.getBoundingClientRect();
      if (width === 0 || height === 0) continue;
      const layers = [];
      for (let each = element; each !== null && each.id !== 'hud'; each = each.parentElement) {
        const style = getComputedStyle(each);
        layers.unshift(parse(style.backgroundColor));
      }
      const colour = parse(getComputedStyle(element).color);
      for (const world of [[255, 255, 255], [0, 0, 0]]) {
        const behind = layers.reduce((below, layer) => blend(layer, below), world);
        const [a, b] = [light(blend(colour, behind)), light(behind)];
        const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
        if (contrast < 4.5) poor.push(`${contrast.toFixed(2)} ${node.textContent.trim().slice(0, 40)}`);
      }
    }
    return [...new Set(poor)];
  });

// Goes through the page by the Tab key: names of what has the focus, until it comes round or leaves the page.
export async function tabThrough(tab, most = 60) {
  const names = [];
  for (let i = 0; i < most; ++i) {
    await tab.keyboard.press('Tab');
    const name = await tab.evaluate(() => {
      const focused = document.activeElement;
      if (focused === null || focused === document.body) return null;
      const { x, y, width, height } = focused.getBoundingClientRect();
      const isIn = x + width > 0 && y + height > 0 && x < innerWidth && y < innerHeight && width > 0;
      const isSeen = focused.id === 'world' || getComputedStyle(focused).outlineStyle !== 'none';
      const label = focused.getAttribute('aria-label') ?? focused.textContent.trim();
      return `${focused.tagName.toLowerCase()} ${label}${isIn ? '' : ' OUTSIDE'}${isSeen ? '' : ' UNSEEN'}`;
    });
    if (name === null || name === names[0]) return names;
    names.push(name);
  }
  throw new Error(`the focus is trapped: ${names.slice(-5)}`);
}
