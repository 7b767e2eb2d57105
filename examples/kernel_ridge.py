"""An encoder of your own: kernel ridge regression of scikit-learn, from touches to a hand pose.

sandbox run box-to-goal --encoder examples/kernel_ridge.py:KernelRidge
"""

from __future__ import annotations

import numpy as np

from encoders import Encoder
from models.errors import EncoderError

try:
    from sklearn import kernel_ridge
    from sklearn.metrics.pairwise import rbf_kernel
except ImportError as error:
    raise EncoderError(
        "scikit-learn is missing", where=__file__, remedy="Install it: pip install scikit-learn"
    ) from error


class KernelRidge(Encoder):
    """A pose is a weighted sum of Gaussian kernels, each centred on one training frame.

    Args:
        alpha: Penalty on the weights.
        gamma: Factor (1 / inch2) of the squared distance in the kernel; larger is narrower.
        frames: Largest number of training frames with a kernel, evenly spaced in the capture.
    """

    def __init__(self, alpha=0.1, gamma=0.03, frames=1000):
        self.alpha, self.gamma, self.frames = alpha, gamma, frames

    def configuration(self):
        return {"alpha": self.alpha, "gamma": self.gamma, "frames": self.frames}

    def fit(self, U, Q):
        some = np.unique(np.linspace(0, len(U) - 1, self.frames).astype(int))
        self.mean, self.places = np.mean(Q, axis=0), U[some]
        learner = kernel_ridge.KernelRidge(alpha=self.alpha, kernel="rbf", gamma=self.gamma)
        self.weights = learner.fit(self.places, Q[some] - self.mean).dual_coef_
        return self

    def predict(self, U):
        kernels = rbf_kernel(np.atleast_2d(U), self.places, gamma=self.gamma)
        return (self.mean + kernels @ self.weights).reshape(*np.shape(U)[:-1], len(self.mean))

    def arrays(self):
        return {"mean": self.mean, "places": self.places, "weights": self.weights}

    def restore(self, arrays, U, Q):
        self.mean, self.places = arrays["mean"], arrays["places"]
        self.weights = arrays["weights"]
        return self
