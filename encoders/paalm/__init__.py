"""PAALM (2013): joint angles from the directions and lengths of fingers that a Leap measures."""

from encoders.paalm.coupling import EQUAL as EQUAL
from encoders.paalm.coupling import TWO_THIRDS as TWO_THIRDS
from encoders.paalm.coupling import Coupling as Coupling
from encoders.paalm.joint_angles import Paalm as Paalm
from encoders.paalm.joint_angles import PaalmFrame as PaalmFrame
from encoders.paalm.joint_angles import PaalmHand as PaalmHand
from encoders.paalm.options import PAPER as PAPER
from encoders.paalm.options import PaalmOptions as PaalmOptions
