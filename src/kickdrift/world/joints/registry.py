"""The joints of a world: their rows in its tables, and the checks of their handles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from weakref import ReferenceType

import numpy as np

from kickdrift.core.errors import ArgumentError
from kickdrift.world.collision.broad_phase.filters_and_sensors import part_joined
from kickdrift.world.joints import layout as j
from kickdrift.world.joints.body_mass_change import follow_mass
from kickdrift.world.joints.breaking import overloaded
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.joint_tables import write_joint
from kickdrift.world.joints.limits_motors_options import Axis
from kickdrift.world.joints.limits_motors_tables import LawPart, check_changeable, read_law, write_law
from kickdrift.world.joints.planar_joints import within_plane
from kickdrift.world.joints.record import Record
from kickdrift.world.joints.spanning_tree import arrange
from kickdrift.world.joints.views import wake_bodies
from kickdrift.world.names import Names
from kickdrift.world.tables import ARTICULATION, JOINT, JOINT_AXES, JOINT_NUMBERS, STARTED_JOINTS, Tables
from kickdrift.world.world_lock import alone, undivided


class Joints:
    """The rows of joints in the tables of a world."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.names = Names("joint")
        self.world: ReferenceType[Any] | None = None
        self.arranged = False
        self.n_made = 0  # never decreases, not even on restoring a snapshot: two joints would share a handle

    def __len__(self) -> int:
        return int((self.tables.array(JOINT)[:, j.JOINT_KIND] != j.REMOVED_JOINT).sum())

    def __iter__(self) -> Iterator[Joint]:
        """Iterate over the handles of all joints."""
        return map(self.handle, np.flatnonzero(self.tables.array(JOINT)[:, j.JOINT_KIND] != j.REMOVED_JOINT).tolist())

    @undivided
    def add(self, record: Record, body_a: int, body_b: int) -> Joint:
        """Join two bodies, given by their rows, in their present poses.

        Raises
        ------
        ArgumentError
            For a body with itself, and for invalid parameters of the record.
        """
        if body_a == body_b:
            raise ArgumentError(
                f"body_b is body_a, row {body_a}, but a joint connects two bodies; give another one, or None for the"
                " ground."
            )
        tables = self.tables
        placement, name = within_plane(record.placement(), tables), self.names.checked(record.name)
        row = self._free_row()
        write_joint(tables, row, (body_a, body_b), record, placement)
        tables.array(JOINT)[row, j.GENERATION] = self.n_made
        self.n_made += 1
        self.arranged = False
        self.names.give(row, name)
        wake_bodies(tables, row)
        return self.handle(row)

    @alone
    def law(self, joint: Any, axis: int | None, part: LawPart) -> Any:
        """Return the limits, the motor, the drive or the friction of an axis, as in an `Axis`."""
        k = joint.axis(axis)
        found = read_law(self.tables, joint.index, k, part)
        return getattr(Axis(**{part: found}).reversed(), part) if joint.sign(k) < 0.0 else found

    @alone
    def change_law(self, joint: Any, axis: int | None, part: LawPart, what: Any) -> None:
        """Replace the limits, the motor, the drive or the friction of an axis, given as in an `Axis`, and wake the bodies.

        Raises
        ------
        ArgumentError
            For axes that are locked, or have no law of their own.
        """
        k, row = joint.axis(axis), joint.index
        check_changeable(self.tables, row, k, part)
        if joint.sign(k) < 0.0:
            what = getattr(Axis(**{part: what}).reversed(), part)
        joint.wake()  # first: Ctrl-C leaves no changed law on bodies that sleep
        numbers = self.tables.row(JOINT, row)
        before, arranged = numbers.item(j.LAWS), self.arranged
        self.arranged = False  # also if Ctrl-C comes now
        write_law(self.tables, row, k, part, what)
        self.arranged = arranged and before == numbers.item(j.LAWS)

    @undivided
    def remove(self, joint: Joint) -> None:
        """Remove a joint.

        Raises
        ------
        ArgumentError
            If it was removed before, or has broken.
        """
        self._remove_row(self.row(joint))

    def remove_of_body(self, body: int) -> None:
        """Remove all joints of a body, before it is removed."""
        joints = self.tables.array(JOINT)
        there = (joints[:, j.JOINT_KIND] != j.REMOVED_JOINT) & (
            (joints[:, j.BODY_A] == body) | (joints[:, j.BODY_B] == body)
        )
        for row in np.flatnonzero(there):
            self._remove_row(int(row))

    @property
    def breakable(self) -> bool:
        """Whether a joint may break."""
        return bool(np.isfinite(self.tables.array(JOINT_NUMBERS)[:, [j.BREAKING_FORCE, j.BREAKING_TORQUE]]).any())

    def take_broken(self) -> list[Joint]:
        """Remove the joints that the last step has overloaded, and return their handles, which only identify them."""
        broken = overloaded(self.tables).tolist()
        handles = [self.handle(row) for row in broken]
        for row in broken:
            self._remove_row(row)
        return handles

    def mass_changed(self, body: int, lighter: float) -> None:
        """Follow the mass of a body that was changed; see `follow_mass`."""
        follow_mass(self.tables, body, lighter)
        self.arranged = False

    def arrange(self) -> None:
        """Sort joints into articulations, and part the bodies that they join, if any joints have come or gone since."""
        if not self.arranged:
            arrange(self.tables)
            part_joined(self.tables)
            self.arranged = self.tables.altered = True

    @property
    def present(self) -> bool:
        """Whether any joint connects a movable body; call `arrange` first."""
        return len(self.tables.array(ARTICULATION)) > 0

    @property
    def sequential(self) -> bool:
        """Whether any joints are solved one after the other; call `arrange` first."""
        return bool(self.tables.array(ARTICULATION)[:, j.SEQUENTIAL].any())

    def row(self, joint: Any, argument: str = "joint") -> int:
        """Return the row of an existing joint.

        Raises
        ------
        ArgumentError
            If it is not a handle, or is one of a joint that was removed or has broken, or of another world.
        """
        if isinstance(joint, Joint) and joint.joints is self and self.knows(joint.index, joint.generation):
            return joint.index
        if not isinstance(joint, Joint):
            raise ArgumentError(
                f"{argument}={joint!r} is not a joint; give a handle returned by World.add_hinge or the like."
            )
        if joint.joints is not self or not 0 <= joint.index < self.tables.count(JOINT):
            raise ArgumentError(
                f"{argument}={joint!r} is a joint of another world; give one of this world, such as world.joint(name)."
            )
        raise ArgumentError(f"{argument}={joint!r} was removed, or has broken; use an existing joint.")

    def knows(self, index: int, generation: int) -> bool:
        """Whether a row holds the joint of a generation."""
        if not 0 <= index < self.tables.count(JOINT):
            return False
        row = self.tables.row(JOINT, index)
        return bool(row.item(j.GENERATION) == generation and row.item(j.JOINT_KIND) != j.REMOVED_JOINT)

    def handle(self, row: int) -> Joint:
        """Return the handle of a row."""
        return Joint(row, self.tables.row(JOINT, row).item(j.GENERATION), self)

    def _free_row(self) -> int:
        joints = self.tables.array(JOINT)
        free = np.flatnonzero(joints[:, j.JOINT_KIND] == j.REMOVED_JOINT)
        if len(free):
            return int(free[0])
        row = len(joints)
        self.tables.resize(JOINT, row + 1)
        self.tables.resize(JOINT_NUMBERS, row + 1)
        self.tables.resize(STARTED_JOINTS, row + 1)
        self.tables.resize(JOINT_AXES, 6 * (row + 1))
        return row

    def _remove_row(self, row: int) -> None:
        wake_bodies(self.tables, row)
        joint = self.tables.array(JOINT)[row]
        joint[[j.JOINT_KIND, j.LOCKED, j.LAWS]] = j.REMOVED_JOINT, 0, 0
        self.names.give(row, None)
        self.tables.version += 1
        self.arranged = False
        joints = self.tables.array(JOINT)
        geared = (joints[:, j.LINEAR] == j.GEARED) & (joints[:, j.JOINT_KIND] != j.REMOVED_JOINT)
        geared &= (joints[:, j.GEARED_JOINTS : j.GEARED_JOINTS + 2] == row).any(axis=1)
        for gear in np.flatnonzero(geared):
            self._remove_row(int(gear))
