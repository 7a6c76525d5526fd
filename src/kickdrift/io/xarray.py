"""Solutions as labelled arrays."""

from typing import TYPE_CHECKING, Any

from kickdrift.core.errors import missing_extra
from kickdrift.engine.solution import Solution

if TYPE_CHECKING:
    from kickdrift.world.recording import Recording


def to_xarray(solution: Solution) -> Any:
    """Return a solution as an `xarray.Dataset` with named dimensions, labels and units.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    try:
        import xarray as xr
    except ImportError:
        raise missing_extra("Solution.to_xarray", "xarray", "xarray") from None
    solution = solution.plain
    about, dims = solution.about, ("time", *solution.about.dimensions)
    units = about.units

    def variable(values: Any, names: tuple[str, ...], of: str) -> Any:
        # What others read as units is one word; a phrase would be an error of theirs.
        key = "units" if " " not in units.get(of, "") else "unit_in_words"
        return xr.Variable(names, values, attrs={key: units[of]} if of in units else {})

    data = {"x": variable(solution.x, dims, "x")}
    if solution.v.shape == solution.x.shape:  # first-order equations have no v
        data["v"] = variable(solution.v, dims, "v")
    for name, values in solution.invariants.items():
        key = name.replace(" ", "_")
        data[key] = variable(values, ("time",) if values.ndim == 1 else ("time", f"{key}_component"), name)
    return xr.Dataset(
        data,
        coords={"time": variable(solution.t, ("time",), "t"), **{k: list(v) for k, v in about.coordinates.items()}},
        attrs={
            "system": about.system,
            "method": about.method,
            "step": solution.step,
            "status": solution.status.name,
            "source": about.source,
        },
    )


def recording_to_xarray(recording: "Recording") -> Any:
    """Return a recording as an `xarray.Dataset`: as `to_xarray`, with orientations and angular velocities.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    units = recording.about.units
    return to_xarray(recording).assign(
        orientation=(("time", "body", "quaternion"), recording.orientation, {"units": "1"}),
        angular_velocity=(
            ("time", "body", "space"), recording.angular_velocity, {"units": units["angular velocity"]}
        ),
        quaternion=list("wxyz"),
    )  # fmt: skip
