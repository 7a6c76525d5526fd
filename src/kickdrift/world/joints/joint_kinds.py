"""The kinds of joints. A new one is a record in its file and a line here; a line in `adding` gives it a method."""

from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.distance import Distance
from kickdrift.world.joints.fixed import Fixed
from kickdrift.world.joints.gear import Gear
from kickdrift.world.joints.hinge import Hinge
from kickdrift.world.joints.record import Record
from kickdrift.world.joints.rope_joint import Rope
from kickdrift.world.joints.six_dof import SixDof
from kickdrift.world.joints.slider import Slider
from kickdrift.world.joints.spring import Spring
from kickdrift.world.joints.universal import Universal

KINDS: tuple[type[Record], ...] = (Ball, Hinge, Slider, Fixed, Universal, SixDof, Distance, Rope, Spring, Gear)
