"""From touches to a hand pose: contact vector, encoders, captures, trained models, PAALM.

The names in `__all__` are the public API; `docs/from-python.md` explains them. Every other module
may change without notice.
"""

from typing import TYPE_CHECKING

from models import lazy_names  # before NumPy: `models` pins the BLAS kernel

if TYPE_CHECKING:
    from encoders.capture import Capture
    from encoders.checks import check_encoder
    from encoders.encoder import Encoder
    from encoders.input_vector import contact_vector
    from encoders.paalm.paalm import Paalm
    from encoders.regression.pca_ik import PcaIkEncoder
    from encoders.regression.polynomial import CubicEncoder, LinearEncoder, QuadraticEncoder
    from encoders.regression.train import save_model, train
    from encoders.regression.trained import TrainedModel, builtin, builtin_capture, load_model
    from encoders.store import load_capture, save_capture
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Capture": "encoders.capture",
            "CubicEncoder": "encoders.regression.polynomial",
            "Encoder": "encoders.encoder",
            "LinearEncoder": "encoders.regression.polynomial",
            "Paalm": "encoders.paalm.paalm",
            "PcaIkEncoder": "encoders.regression.pca_ik",
            "QuadraticEncoder": "encoders.regression.polynomial",
            "TrainedModel": "encoders.regression.trained",
            "builtin": "encoders.regression.trained",
            "builtin_capture": "encoders.regression.trained",
            "check_encoder": "encoders.checks",
            "contact_vector": "encoders.input_vector",
            "load_capture": "encoders.store",
            "load_model": "encoders.regression.trained",
            "save_capture": "encoders.store",
            "save_model": "encoders.regression.train",
            "train": "encoders.regression.train",
        },
    )

__all__ = [
    "Capture",
    "CubicEncoder",
    "Encoder",
    "LinearEncoder",
    "Paalm",
    "PcaIkEncoder",
    "QuadraticEncoder",
    "TrainedModel",
    "builtin",
    "builtin_capture",
    "check_encoder",
    "contact_vector",
    "load_capture",
    "load_model",
    "save_capture",
    "save_model",
    "train",
]
