"""How a player's page leaves and finds back, in a real Chromium: `python -m benchmarks.page_away`.

Prints a table, a row for each way of leaving: simulated time that ran on before it stood still,
whether it then stood still, real seconds from the return until the page can be played, and whether
the page was in the same trial. Needs Debian's chromium, which draws in software here.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from tests.support.chromium import Browser
from tests.system.browser.away_page import (
    absence,
    contacts,
    go_back,
    hide,
    lose_network,
    playing,
    reload,
    replays,
    throw_away,
    turn,
)

WAYS = (
    ("reload", reload, 0.0),
    ("another page, and back", go_back, 2.0),
    ("tab thrown away by the system", throw_away, 2.0),
    ("hidden for 10 s", hide, 10.0),
    ("network gone for 3 s, fingers rest", lose_network, 3.0),
    ("network gone for 10 s, fingers rest", lose_network, 10.0),
    ("screen turned, and turned back", turn, 2.0),
)


def main() -> None:
    """Plays every way of leaving, and prints the table."""
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors\n")
    heads = "away", "clock ran on, s", "stood still", "back after, s", "same trial"
    print("| " + " | ".join((*heads, "contacts", "replays")) + " |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(Path(folder))
        for words, kind, seconds in WAYS:
            place = Path(tempfile.mkdtemp(dir=folder))
            with playing(browser, place) as page:
                page.begin()
                seen = absence(page, kind, seconds)
            cells = (
                f"{seen.ran_on_s:.2f}",
                "yes" if seen.stood_still else "no",
                f"{seen.back_s:.2f}",
                "yes" if seen.same_trial else "no",
                "the same" if len(contacts(place)) == 2 else "new",
                "yes" if replays(place) else "no",
            )
            print(f"| {words} | {' | '.join(cells)} |", flush=True)
        browser.close()


if __name__ == "__main__":
    main()
