// Whether the window has a size, for which a table can be laid.

/** False in a window that has no size yet, or is minimized. */
export const sized = (): boolean => window.innerWidth >= 1 && window.innerHeight >= 1;
