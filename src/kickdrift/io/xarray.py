"""Solutions as labelled arrays."""

from typing import TYPE_CHECKING, Any

from kickdrift.core.errors import missing_extra
from kickdrift.engine.description import unit_attributes
from kickdrift.engine.solution import Solution
from kickdrift.io.swept import check_swept
from kickdrift.scale.ensemble_solution import EnsembleSolution

if TYPE_CHECKING:
    from kickdrift.world.recordings.recording import Recording


def to_xarray(solution: Solution) -> Any:
    """Return a solution as an `xarray.Dataset` with named dimensions, labels and units; rows on disk are read as needed.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    plain = solution.plain
    if plain.saved_to:
        return _xarray().open_zarr(plain.saved_to)
    return _dataset(plain, ("time",)).assign_attrs(step=plain.step, status=solution.status.name)


def ensemble_to_xarray(solution: EnsembleSolution) -> Any:
    """Return the solution of an ensemble as an `xarray.Dataset`, whose first dimension is ``member``.

    What was swept, steps and outcomes are coordinates of the members.

    Raises
    ------
    KickdriftError
        If what was swept has the name of an array.
    MissingExtraError
        If xarray is not installed.
    """
    if solution.saved_to:
        return _xarray().open_zarr(solution.saved_to)
    status = [status.name for status in solution.status]
    labels = {
        name: (("member",) if values.ndim == 1 else ("member", "parameter"), values)
        for name, values in solution.parameters.items()
    }
    of_members = {"step": ("member", solution.step), "status": ("member", status)}
    data = _dataset(solution, ("member", "time"))
    check_swept(labels, data.variables)
    return data.assign_coords({**labels, **of_members})


def _dataset(solution: Solution | EnsembleSolution, leading: tuple[str, ...]) -> Any:
    """Return states and invariants with named dimensions, the leading ones first."""
    xr = _xarray()
    about, dims = solution.about, (*leading, *solution.about.dimensions)
    units = about.units

    def variable(values: Any, names: tuple[str, ...], of: str) -> Any:
        return xr.Variable(names, values, attrs=unit_attributes(units.get(of, "")))

    data = {"x": variable(solution.x, dims, "x")}
    if solution.v.shape == solution.x.shape:  # first-order equations have no v
        data["v"] = variable(solution.v, dims, "v")
    for name, values in solution.invariants.items():
        key = name.replace(" ", "_")
        own = leading if values.ndim == len(leading) else (*leading, f"{key}_component")
        data[key] = variable(values, own, name)
    return xr.Dataset(
        data,
        coords={"time": variable(solution.t, ("time",), "t"), **{k: list(v) for k, v in about.coordinates.items()}},
        attrs={"system": about.system, "method": about.method, "source": about.source},
    )


def _xarray() -> Any:
    try:
        import xarray
    except ImportError:
        raise missing_extra("Solution.to_xarray", "xarray", "xarray") from None
    return xarray


def recording_to_xarray(recording: "Recording") -> Any:
    """Return a recording as an `xarray.Dataset`: as `to_xarray`, with orientations and angular velocities.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    units = recording.about.units
    if recording.saved_to:
        return to_xarray(recording)
    return to_xarray(recording).assign(
        orientation=(("time", "body", "quaternion"), recording.orientation, {"units": "1"}),
        angular_velocity=(
            ("time", "body", "space"), recording.angular_velocity, {"units": units["angular velocity"]}
        ),
        quaternion=list("wxyz"),
    )  # fmt: skip
