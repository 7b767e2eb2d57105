"""From touches to a hand pose: contact vector, encoders, captures, trained models, PAALM.

The names in `__all__` are the public API; `docs/from-python.md` explains them. Every other module
may change without notice.
"""

from typing import TYPE_CHECKING

from models import lazy_names  # before NumPy: `models` pins the BLAS kernel

if TYPE_CHECKING:
    from encoders.capture import Capture, load_capture, save_capture
    from encoders.encoder import Encoder
    from encoders.encoder_checks import check_encoder
    from encoders.input_vector import contact_vector
    from encoders.paalm.joint_angles import Paalm
    from encoders.regression.pca_ik import PcaIkEncoder
    from encoders.regression.polynomial import CubicEncoder, LinearEncoder, QuadraticEncoder
    from encoders.regression.trained import TrainedModel, builtin, builtin_capture, load_model
    from encoders.regression.training import save_model, train
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Capture": "encoders.capture",
            "CubicEncoder": "encoders.regression.polynomial",
            "Encoder": "encoders.encoder",
            "LinearEncoder": "encoders.regression.polynomial",
            "Paalm": "encoders.paalm.joint_angles",
            "PcaIkEncoder": "encoders.regression.pca_ik",
            "QuadraticEncoder": "encoders.regression.polynomial",
            "TrainedModel": "encoders.regression.trained",
            "builtin": "encoders.regression.trained",
            "builtin_capture": "encoders.regression.trained",
            "check_encoder": "encoders.encoder_checks",
            "contact_vector": "encoders.input_vector",
            "load_capture": "encoders.capture",
            "load_model": "encoders.regression.trained",
            "save_capture": "encoders.capture",
            "save_model": "encoders.regression.training",
            "train": "encoders.regression.training",
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
