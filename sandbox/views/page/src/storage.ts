// The page's storage. A browser may forbid it; then nothing is stored, and the page still works.

function read(store: () => Storage, key: string): string | null {
  try {
    return store().getItem(key);
  } catch {
    return null;
  }
}

function write(store: () => Storage, key: string, value: string): void {
  try {
    store().setItem(key, value);
  } catch {
    // Private browsing: nothing is kept.
  }
}

const lasting = (): Storage => window.localStorage;
const session = (): Storage => window.sessionStorage;

/** Kept on this device. */
export const recall = (key: string): string | null => read(lasting, `hand-sandbox:${key}`);
export const remember = (key: string, value: string): void =>
  write(lasting, `hand-sandbox:${key}`, value);

/** Kept until this tab is closed. */
export const recallHere = (key: string): string | null => read(session, `hand-sandbox:${key}`);
export const rememberHere = (key: string, value: string): void =>
  write(session, `hand-sandbox:${key}`, value);
