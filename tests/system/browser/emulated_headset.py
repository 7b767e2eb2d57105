"""An emulated headset in Chromium: IWER, which npm fetches with what builds the page.

Nobody wears it: tests say where the joints of its hands are.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from tests.support.chromium import Browser, Tab
from tests.support.needs import IWER

_WORN = """
{
  // The lowest quality: software draws slowly.
  localStorage.setItem("hand-sandbox:quality", "3");
  const device = new IWER.XRDevice(IWER.metaQuest3);
  device.installRuntime({ forceInstall: true });
  device.primaryInputMode = "hand";
  globalThis.device = device;
  const symbol = (object, name) =>
    Object.getOwnPropertySymbols(object).find((s) => s.description === name);
  globalThis.show = (told) => {
    for (const side of ["left", "right"]) {
      const hand = device.hands[side];
      hand.connected = Boolean(told[side]);
      if (!told[side]) continue;
      hand.position.set(0, 0, 0);
      hand.quaternion.set(0, 0, 0, 1);
      const spaces = [...hand.inputSource.hand.values()];
      const key = symbol(spaces[0], "@iwer/xr-space");
      hand.updateHandPose = () => spaces.forEach((space, i) => {
        const at = told[side][i];
        space[key].offsetMatrix.set([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...at, 1]);
      });
    }
    return true;
  };
  show({});
}
"""


def worn(browser: Browser, address: str) -> Tab:
    """Opens an address in a browser that is on an emulated headset."""
    tab = browser.open("about:blank")
    script = f"{IWER.read_text(encoding='utf-8')}\n{_WORN}"
    tab.call("Page.addScriptToEvaluateOnNewDocument", source=script)
    tab.call("Page.navigate", url=address)
    return tab


def show(tab: Tab, hands: Mapping[str, Sequence[Sequence[float]]]) -> Any:
    """Shows hands to the headset: 25 places (m) in the room by side, y up and -z ahead."""
    return tab.evaluate(f"show({json.dumps({s: list(p) for s, p in hands.items()})})")
