// Tablets whose size their makers publish, for people who have no card at hand.

import known from "./devices.json";

export interface KnownDevice {
  name: string;
  /** CSS pixels per inch on this screen, if it is this device. */
  pxPerInch: number;
}

interface Published {
  name: string;
  long_px: number;
  short_px: number;
  ppi?: number;
  diagonal_in?: number;
}

/** Share by which the proportions of a screen may differ from the published ones: bars of the system are
 * no part of some screens. */
const ALIKE = 0.06;

/** Inches of the longer side. */
const longSide = ({ long_px, short_px, ppi, diagonal_in }: Published): number =>
  long_px / (ppi ?? Math.hypot(long_px, short_px) / diagonal_in!);

/** The devices that this screen may be, by its proportions. A system may show everything larger or
 * smaller, so that its pixels say nothing. */
export function knownDevices(): KnownDevice[] {
  const { width, height } = window.screen;
  const long = Math.max(width, height);
  const ratio = long / Math.min(width, height);
  return known.devices
    .filter((one) => Math.abs(one.long_px / one.short_px / ratio - 1) < ALIKE)
    .map((one) => ({ name: one.name, pxPerInch: long / longSide(one) }));
}
