"""Everything that a page shows or names, for tests that look for words of another language."""

from __future__ import annotations

import re

from tests.support.chromium import Tab

WATCH = """
(() => {
  const seen = window.seenWords = new Set();
  const fill = CanvasRenderingContext2D.prototype.fillText;
  CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
    seen.add(text);
    return fill.call(this, text, ...rest);
  };
  const foreign = (element) => {
    const own = element.closest("[lang]");
    return own && own !== document.documentElement && own.lang !== document.documentElement.lang;
  };
  const look = () => {
    if (!document.body) return;
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      const place = texts.currentNode.parentElement;
      if (place.closest("script, noscript") || foreign(place)) continue;
      if (place.checkVisibility()) seen.add(texts.currentNode.textContent);
    }
    for (const element of document.body.querySelectorAll("[aria-label], [placeholder], [title]"))
      if (element.checkVisibility() && !foreign(element))
        for (const name of ["aria-label", "placeholder", "title"])
          seen.add(element.getAttribute(name) ?? "");
  };
  // Ten times a second: what is shown for less, nobody reads.
  let waits = false;
  const later = () => {
    if (!waits) setTimeout(() => ((waits = false), look()), 100);
    waits = true;
  };
  new MutationObserver(later).observe(document, {
    subtree: true, childList: true, characterData: true, attributes: true,
  });
})()
"""
"""Keeps all texts that a page ever shows, on its canvases too, and names for screen readers."""

WORD = re.compile(r"[^\W\d_]{2,}")


def watch(tab: Tab) -> None:
    """Begins to look, from the next page on that this tab opens."""
    tab.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH)


def seen(tab: Tab) -> set[str]:
    """Texts that this page has shown."""
    return set(tab.evaluate("[...seenWords]"))


def words(*texts: str) -> set[str]:
    """Words of texts, of two letters and more."""
    return {word.lower() for text in texts for word in WORD.findall(text)}
