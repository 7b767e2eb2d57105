"""From touches to a pose: contact vector, encoders, labels, correction, reconstructor."""

import models  # noqa: F401  (before NumPy: it pins the BLAS kernel)
from encoders.contact_vector import contact_vector as contact_vector
from encoders.paalm import Paalm as Paalm
from encoders.regression.pca_ik import PcaIkEncoder as PcaIkEncoder
from encoders.regression.polynomial import CubicEncoder as CubicEncoder
from encoders.regression.polynomial import LinearEncoder as LinearEncoder
from encoders.regression.polynomial import QuadraticEncoder as QuadraticEncoder
