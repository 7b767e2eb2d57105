"""Reads our streams in a process of its own, as another instrument's computer would.

Usage: lsl_reader.py SOURCE OUT. Writes JSON lines: the stream's name, the stamp and the sample;
ends with the marker `trial_end`, or after a minute.
"""

from __future__ import annotations

import json
import sys
import time

import pylsl


def main(source: str, out: str) -> None:
    wanted = {"sandbox_touch": "touch", "sandbox_hand": "hand", "sandbox_markers": "markers"}
    inlets = {}
    for name, kind in wanted.items():
        (found,) = pylsl.resolve_byprop("source_id", f"{source}-{kind}", timeout=30.0)
        inlets[name] = pylsl.StreamInlet(found)
        labels = []
        channel = inlets[name].info(10.0).desc().child("channels").child("channel")
        while not channel.empty():
            labels.append(channel.child_value("label"))
            channel = channel.next_sibling()
        inlets[name].labels = labels
    for name, inlet in inlets.items():
        if name != "sandbox_markers":
            inlet.open_stream(10.0)
    # The other side begins when somebody listens to the markers.
    inlets["sandbox_markers"].open_stream(10.0)
    over, until = False, time.monotonic() + 60.0
    with open(out, "w", encoding="utf-8") as file:
        for name, inlet in inlets.items():
            told = {"stream": name, "labels": inlet.labels, "rate": inlet.info().nominal_srate()}
            file.write(json.dumps(told) + "\n")
        while time.monotonic() < until:
            heard = False
            for name, inlet in inlets.items():
                samples, stamps = inlet.pull_chunk(timeout=0.0)
                for sample, stamp in zip(samples, stamps, strict=True):
                    heard = True
                    told = {"stream": name, "stamp": stamp, "sample": sample}
                    file.write(json.dumps(told) + "\n")
                    over = over or (name == "sandbox_markers" and "trial_end" in sample[0])
            if over and not heard:
                break
            time.sleep(0.2 if over else 0.01)


if __name__ == "__main__":
    main(*sys.argv[1:])
