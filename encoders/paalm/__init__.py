"""PAALM (2013): joint angles from the directions and lengths of fingers that a Leap measures."""

from encoders.paalm.coupling import EQUAL as EQUAL
from encoders.paalm.coupling import TWO_THIRDS as TWO_THIRDS
from encoders.paalm.coupling import Coupling as Coupling
from encoders.paalm.options import PAPER as PAPER
from encoders.paalm.options import PaalmOptions as PaalmOptions
from encoders.paalm.paalm import Paalm as Paalm
from encoders.paalm.paalm import PaalmFrame as PaalmFrame
from encoders.paalm.paalm import PaalmHand as PaalmHand
