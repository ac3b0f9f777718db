// Short functions that make the page's elements.

export function MakeElement<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className = '',
  text = '',
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (className !== '') element.className = className;
  if (text !== '') element.textContent = text;
  return element;
}

// The style sheet shows the key beside the text; screen readers are told it apart from the label.
export function ShowKey(button: HTMLButtonElement, key: string): void {
  button.dataset.key = key;
  button.setAttribute('aria-keyshortcuts', key);
}

// label: for screen readers. key: shown beside the text; empty: none.
export function MakeButton(text: string, label: string, key: string, onClick: () => void): HTMLButtonElement {
  const button = MakeElement('button', '', text);
  button.type = 'button';
  button.setAttribute('aria-label', label);
  button.title = key === '' ? label : `${label} (${key})`;
  if (key !== '') ShowKey(button, key);
  button.addEventListener('click', () => {
    onClick();
    // Without this the space bar, which jumps, would press the button again.
    if (document.activeElement === button && !button.matches(':focus-visible')) button.blur();
  });
  return button;
}

// Over all the page, with the focus inside until it is closed, which Escape does. The keys of the world do not act.
export function MakeDialog(className: string, label: string): HTMLDialogElement {
  const dialog = MakeElement('dialog', className);
  dialog.setAttribute('aria-label', label);
  dialog.addEventListener('keydown', (event) => event.stopPropagation());
  return dialog;
}

export function SetPressed(button: HTMLButtonElement, isPressed: boolean): void {
  const pressed = String(isPressed);
  if (button.getAttribute('aria-pressed') !== pressed) button.setAttribute('aria-pressed', pressed);
}

// Sets the text only when it differs; otherwise the browser would compute the layout in each frame.
export function SetText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export interface Slider {
  element: HTMLElement;
  // Moves the slider without calling onInput; does nothing while the player holds it.
  Set(value: number): void;
}

// toValue: converts from the slider's share 0..1; toShare is its inverse.
export function MakeSlider(
  text: string,
  toValue: (share: number) => number,
  toShare: (value: number) => number,
  show: (value: number) => string,
  onInput: (value: number) => void,
): Slider {
  const element = MakeElement('label', 'field');
  const line = MakeElement('span', '', text);
  const output = MakeElement('output');
  line.append(output);
  const input = MakeElement('input');
  input.type = 'range';
  input.min = '0';
  input.max = '1000';
  input.setAttribute('aria-label', text);
  element.append(line, input);
  let isHeld = false;
  input.addEventListener('pointerdown', () => (isHeld = true));
  for (const end of ['pointerup', 'pointercancel', 'blur'] as const) {
    input.addEventListener(end, () => (isHeld = false));
  }
  input.addEventListener('input', () => {
    const value = toValue(Number(input.value) / 1000);
    SetText(output, show(value));
    onInput(value);
  });
  return {
    element,
    Set(value: number): void {
      if (isHeld) return;
      const share = String(Math.round(1000 * Math.max(0, Math.min(1, toShare(value)))));
      if (input.value !== share) input.value = share;
      SetText(output, show(value));
    },
  };
}

// A scale on which equal distances are equal ratios.
export function MakeLogarithmicScale(least: number, most: number) {
  return {
    toValue: (share: number) => least * Math.pow(most / least, share),
    toShare: (value: number) => Math.log(Math.max(value, least) / least) / Math.log(most / least),
  };
}
