"""Recordings: the motion of a world, as a solution with bodies as a dimension."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import KickdriftError, UnknownNameError, unknown_name
from kickdrift.engine.solution import Solution
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.recordings.appearance import Appearance, DrawnCloth
from kickdrift.world.recordings.viewer_hooks import WorldPresenters

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Recording(Solution):
    """The motion of a world: a `Solution` in which row n of x and v is body n, and row 0 the ground.

    Attributes
    ----------
    t : (T,) array
        Times kept, s.
    x, v : (T, N, 3) array
        Centres of mass, m, and their velocities, m/s.
    orientation : (T, N, 4) array
        Quaternions (w, x, y, z) that turn the bodies' axes into the world's.
    angular_velocity : (T, N, 3) array
        In the world's axes, rad/s.
    particles : (T, P, 3) array
        Vertices of all cloths, ropes and soft bodies, m; `cloth` returns those of one.
    contact_points : (T, K, 3) array
        Points at which bodies pressed on each other, m, and NaN after the last one of a row; K is 0 unless
        ``contact_points=True`` was given to `World.run` or `World.record`.
    appearance : Appearance
        Shapes, joints and cloths, for drawing.
    invariants : mapping of str to array
        "energy", J, (T,); "momentum", kg m/s, and "angular momentum", kg m^2/s, (T, 3).
    derived : mapping of str to array
        Each (T,): "kinetic energy" and "potential energy", J; "overlap", the largest penetration of bodies in contact, and
        "joint gap", the largest error of the distance that a joint holds, m; and "residual", `World.residual`, m/s.

    Notes
    -----
    The other attributes, such as `status` and `n_steps`, are those of `Solution`. A world has no events, error estimates and
    multipliers; q and y are x, and p is v, as in every solution. `continue_to`, `return_to` and ``recording(t)`` raise errors:
    only the world can go on, and its states are known only at its steps.

    Examples
    --------
    >>> import kickdrift as kd
    >>> world = kd.World()
    >>> ball = world.add_sphere(radius=0.1, mass=1.0, name="ball")
    >>> recording = world.run(duration=1.0, step=1 / 60)
    >>> recording.x[-1, recording.row("ball")].round(3)
    array([ 0.   ,  0.   , -4.905])
    >>> recording.moving
    array([1])
    """

    orientation: Floats
    angular_velocity: Floats
    particles: Floats
    contact_points: Floats
    appearance: Appearance

    presenters: ClassVar[WorldPresenters]

    def __repr__(self) -> str:
        return f"<Recording of a {self.about.system}: {self._in_words()}>"

    def __call__(self, t: ArrayLike) -> NoReturn:
        """Refuse, since the states of a world are known only at its steps.

        Raises
        ------
        KickdriftError
            Always; it says what to do instead.
        """
        where = f"the rows in {self.saved_to!r}" if self.saved_to else "the rows at recording.t"
        raise KickdriftError(f"the states of a world are known only at its steps; interpolate between {where}.")

    def continue_to(self, t: float) -> Solution:
        """Refuse, since only the world can be continued.

        Parameters
        ----------
        t : float

        Raises
        ------
        KickdriftError
            Always; it says what to do instead.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1)
        >>> recording = world.run(duration=0.5, step=1 / 60)
        >>> recording = world.run(duration=0.5, step=1 / 60)  # continues
        >>> round(world.time, 12)
        1.0
        """
        raise KickdriftError(
            "a recording cannot be continued, but its world can: world.run(duration, step) continues from its current"
            " state."
        )

    def return_to(self, t: float) -> Solution:
        """Refuse, since the steps of a world are not reversible.

        Parameters
        ----------
        t : float

        Raises
        ------
        KickdriftError
            Always.

        Examples
        --------
        >>> import kickdrift as kd
        >>> recording = kd.World().run(duration=0.1, step=0.01)
        >>> try:
        ...     recording.return_to(0.0)
        ... except kd.KickdriftError as error:
        ...     print(error)
        the steps of a world, with contacts, do not lead back; earlier states are in its rows.
        """
        raise KickdriftError("the steps of a world, with contacts, do not lead back; earlier states are in its rows.")

    def __getattr__(self, name: str) -> Any:
        known = name in self.__dataclass_fields__
        raise AttributeError(
            f"{name} is available once the block of World.record has ended."
            if known
            else f"a Recording has no {name!r}."
        )

    @property
    def moving(self) -> NDArray[np.intp]:
        """Rows of the dynamic bodies: neither static nor kinematic."""
        return np.flatnonzero(self.appearance.kinds == DYNAMIC)

    def row(self, name: str) -> int:
        """Return the row of the body with a name, as in ``recording.x[:, recording.row("ball")]``.

        Parameters
        ----------
        name : str

        Returns
        -------
        int

        Raises
        ------
        UnknownNameError
            If no body had it at the end; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, name="ball")
        >>> world.run(duration=0.1, step=1 / 60).row("ball")
        1
        """
        rows = {known: row for row, known in self.appearance.names.items()}
        if name not in rows:
            raise unknown_name("name", name, rows)
        return rows[name]

    def cloth(self, which: str | int = 0) -> Floats:
        """Return the positions of the vertices of a cloth, a rope or a soft body.

        Parameters
        ----------
        which : str or int
            Its name, or its index among all of them in the world.

        Returns
        -------
        (T, N, 3) array
            m.

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(vertices=(3, 3), name="sheet")
        >>> recording = world.run(duration=0.1, step=1 / 60)
        >>> recording.cloth("sheet").shape
        (7, 9, 3)
        """
        cloth = self.drawn_cloth(which)
        return self.particles[:, cloth.first : cloth.last]

    def drawn_cloth(self, which: str | int) -> DrawnCloth:
        """Return what is drawn of a cloth, a rope or a soft body, and which particles are its vertices; see `cloth`."""
        known: dict[Any, DrawnCloth] = dict(enumerate(self.appearance.cloths))
        known |= {cloth.name: cloth for cloth in self.appearance.cloths if cloth.name is not None}
        if not known:
            raise UnknownNameError("the world of this recording has no cloth, rope or soft body.")
        if which not in known:
            raise unknown_name("which", str(which), [str(name) for name in known])
        return known[which]

    def save_meshes(self, folder: str | Path, which: str | int = 0, *, form: str = "obj") -> Path:
        """Write the surface of a cloth, a rope or a soft body as meshes for rendering: one file per row, numbered from zero.

        They replace all those of the same name in the folder.

        Parameters
        ----------
        folder : path
            Folder for the files; created if missing.
        which : str or int
            As in `cloth`.
        form : {"obj", "glb"}
            Wavefront OBJ, or binary glTF.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        UnknownNameError
            If there is no such cloth.
        FileFormatError
            If the folder cannot be written.
        MissingExtraError
            If trimesh is not installed.

        Examples
        --------
        >>> from tempfile import mkdtemp
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> sheet = world.add_cloth_grid(vertices=(3, 3), name="sheet")
        >>> recording = world.run(duration=0.1, step=1 / 60)
        >>> folder = recording.save_meshes(mkdtemp(), "sheet")
        >>> sorted(path.name for path in folder.iterdir())[:2]
        ['sheet-000000.obj', 'sheet-000001.obj']
        """
        return self.presenters.save_meshes(self, folder, which, form)

    def animate(self, path: str | Path, *, speed: float = 1.0, rate: int = 25, progress: bool | None = None) -> Path:
        """Write an animation of the recording; return its path.

        Parameters
        ----------
        path : path
            Ends in ``.gif``, or in ``.mp4`` if the program ffmpeg is installed.
        speed : float
            Seconds of the recording per second of the animation.
        rate : int
            Frames per second, at most 50.
        progress : bool, optional
            Whether to show a progress bar; by default on a terminal, if it takes more than two seconds.

        Returns
        -------
        Path

        Raises
        ------
        ArgumentError
            For an invalid speed or rate.
        FileFormatError
            If the file cannot be written, or ffmpeg is missing.
        MissingExtraError
            If matplotlib is not installed.

        Examples
        --------
        >>> from tempfile import mkdtemp
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1)
        >>> recording = world.run(duration=0.1, step=1 / 60)
        >>> recording.animate(mkdtemp() + "/fall.gif", progress=False).name
        'fall.gif'
        """
        return self.presenters.animate(self, path, speed=speed, rate=rate, progress=progress)
