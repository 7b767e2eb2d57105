"""An encoder from Python: train it on a capture, test it on unseen takes, save it, predict.

python examples/train_and_predict.py [CAPTURE.npz]

`sandbox subject` and `sandbox capture` make captures. Without an argument, the built-in capture of
the simulated subject is taken.
"""

import sys

import numpy as np

from encoders import (
    QuadraticEncoder,
    builtin_capture,
    contact_vector,
    load_capture,
    load_model,
    save_model,
    train,
)
from models import ADULT, Kinematics

capture = load_capture(sys.argv[1]) if len(sys.argv) > 1 else builtin_capture()
print(f"{len(capture)} frames of {len(np.unique(capture.trial))} takes")

# Frames of one take depend on each other, so whole takes are held out.
held_out = capture.trial % 5 == 0
learned, unseen = capture.select(~held_out), capture.select(held_out)
encoder = QuadraticEncoder(ridge=1e-3).fit(learned.u, learned.relative)
error = encoder.predict(unseen.u) - unseen.relative
print(f"mean wrist error {100 * np.linalg.norm(error[:, :3], axis=1).mean():.2f} cm")

# A model that sessions can use: `sandbox run box-to-goal --encoder mine.npz`.
save_model(train(capture, "mine", degree=2, ridge=1e-3), "mine.npz")
model = load_model("mine.npz")

# Thumb and index finger, inches; the pose is relative to the leftmost contact.
u = contact_vector({0: (2.1, 3.9), 1: (3.0, 1.8)})
q = model.encoder.predict(u)
tips = Kinematics(ADULT).place(q).tips
print(f"pose {q.shape}, thumb tip at {np.round(100 * tips[0], 1)} cm")
