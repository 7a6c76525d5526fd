"""Solutions on disk, as labelled arrays, and as a report."""

import contextlib
import json
import pickle
import zipfile

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core import archive
from kickdrift.core.errors import FileFormatError, MissingExtraError


@pytest.fixture(scope="module")
def planets():
    return kd.solve(kd.systems.solar_system(["Sun", "Earth", "Jupiter"]), (0.0, 100.0), step=1.0, save_every=10)


def test_saved_and_loaded_solutions_are_equal(planets, tmp_path):
    path = planets.save(tmp_path / "planets")
    assert path == tmp_path / "planets.npz"
    loaded = kd.load(path)
    for name in ("t", "x", "v", "energy"):
        assert np.array_equal(getattr(loaded, name), getattr(planets, name))
    assert set(loaded.invariants) == {"energy", "momentum", "angular momentum"}
    for name in ("status", "message", "step", "n_steps", "n_force_evaluations", "wall_time", "about"):
        assert getattr(loaded, name) == getattr(planets, name)
    assert loaded.report() == planets.report()
    assert loaded.save(tmp_path / "again").exists()


def test_solutions_travel_between_processes(planets):
    copy = pickle.loads(pickle.dumps(planets))
    assert np.array_equal(copy.x, planets.x)
    assert np.array_equal(copy.energy, planets.energy)


def test_other_tools_open_the_file(planets, tmp_path):
    with np.load(planets.save(tmp_path / "planets.npz"), allow_pickle=False) as file:
        assert file["x"].shape == (11, 3, 3)
        assert json.loads(str(file["header"]))["about"]["coordinates"]["body"] == ["Sun", "Earth", "Jupiter"]


def test_saving_twice_replaces_and_leaves_nothing_else(planets, tmp_path):
    planets.save(tmp_path / "a.npz")
    planets.save(tmp_path / "a.npz")
    assert [p.name for p in tmp_path.iterdir()] == ["a.npz"]


def _text(path):
    path.write_text("not a solution")


def test_the_message_evaluates_the_energy_when_it_is_read_and_once():
    seen = []

    def energy(x, v):
        seen.append(x)
        return 0.5 * (v * v + x * x)

    spring = kd.SecondOrder(lambda x: -x, energy=energy)
    sol = kd.solve(spring, (0.0, 25.0), 1.0, 0.0, step=2.5, compile=False)  # unstable
    assert set(seen) == {1.0}  # tried at the start
    other = pickle.loads(pickle.dumps(sol))
    assert "The energy error is" in sol.message
    assert sol.x[-1] in seen
    count = len(seen)
    assert other.message == sol.message
    assert other.about == sol.about
    assert len(seen) == count


def _pickle(path):
    path.write_bytes(pickle.dumps({"t": [1]}))


def _object_array(path):
    np.savez(path, header=np.array([{}], dtype=object))


def _foreign_arrays(path):
    np.savez(path, a=np.zeros(3))


def _bad_header(path):
    np.savez(path, header=np.array("{"))


def _other_format(path):
    np.savez(path, header=np.array(json.dumps({"format": "something else"})))


def _empty_zip(path):
    zipfile.ZipFile(path, "w").close()


def _single_array(path):
    with path.open("wb") as file:
        np.save(file, np.zeros(3))


def _empty(path):
    path.touch()


def test_a_file_of_text_is_refused_without_the_advice_to_load_pickles(tmp_path):
    path = tmp_path / "notes.npz"
    path.write_text("hello")
    with pytest.raises(
        FileFormatError, match=r"is not a kickdrift solution .not an npz file of plain arrays.; give"
    ) as caught:
        kd.load(path)
    assert "pickle" not in str(caught.value)


@pytest.mark.parametrize(
    "write",
    [_text, _pickle, _object_array, _foreign_arrays, _bad_header, _other_format, _empty_zip, _single_array, _empty],
)
def test_files_that_are_not_ours_are_refused(write, tmp_path):
    path = tmp_path / "other.npz"
    write(path)
    with pytest.raises(FileFormatError, match="is not a kickdrift solution"):
        kd.load(path)


def test_truncated_files_are_refused(planets, tmp_path):
    path = planets.save(tmp_path / "a.npz")
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(FileFormatError):
        kd.load(path)


def test_shapes_that_do_not_match_are_refused(planets, tmp_path):
    path = planets.save(tmp_path / "a.npz")
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays.pop("header")))
    arrays["x"] = arrays["x"][:-1]
    archive.write(path, header, arrays)
    with pytest.raises(FileFormatError, match="have shapes"):
        kd.load(path)


def test_numbers_that_were_changed_after_they_were_written_are_refused(planets, tmp_path):
    path = planets.save(tmp_path / "a.npz")
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    arrays["x"][3] += 1e-9
    with path.open("wb") as out:
        np.savez(out, **arrays)
    with pytest.raises(FileFormatError, match="was changed after it was written"):
        kd.load(path)


def test_damaged_files_are_refused_or_read(planets, tmp_path):
    path = planets.save(tmp_path / "a.npz")
    whole = path.read_bytes()
    rng = np.random.default_rng(5)
    for position in rng.integers(0, len(whole), 200):
        damaged = bytearray(whole)
        damaged[position] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        with contextlib.suppress(FileFormatError):
            kd.load(path).report()


@pytest.mark.parametrize("name", ["", ".", "/", "..", "a" * 300, "a\0b"])
def test_paths_that_name_no_file_are_errors(planets, name):
    with pytest.raises(FileFormatError):
        planets.save(name)


def test_missing_files_and_folders_are_errors(planets, tmp_path):
    with pytest.raises(FileFormatError, match="cannot be read"):
        kd.load(tmp_path / "missing.npz")
    with pytest.raises(FileFormatError, match="cannot be written"):
        planets.save(tmp_path / "missing" / "a.npz")


def test_labelled_arrays_have_names_and_units(planets):
    data = planets.to_xarray()
    assert data.x.dims == ("time", "body", "space")
    assert data.x.attrs["units"] == "au"
    assert data.time.attrs["units"] == "day"
    assert np.array_equal(data.x.sel(body="Earth", space="y"), planets.x[:, 1, 1])
    assert data.energy.dims == ("time",)
    assert data.angular_momentum.shape == (11, 3)
    scalar = kd.solve(kd.systems.pendulum(), (0.0, 1.0), step=0.1).to_xarray()
    assert scalar.x.dims == ("time",)
    plain = kd.solve(lambda x: -x, (0.0, 1.0), np.ones((2, 3)), np.zeros((2, 3)), step=0.5, compile=False).to_xarray()
    assert plain.x.dims == ("time", "axis_0", "axis_1")


def test_without_xarray_the_error_names_the_extra(planets, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'kickdrift\[xarray\]'"):
        planets.to_xarray()


def test_the_report_says_what_was_asked_for(planets):
    text = planets.report()
    for word in (
        "solar-system",
        "semi-implicit-euler, order 1",
        "K D",
        "100",
        "ns per step",
        "energy error",
        "energy drift",
    ):
        assert word in text
    assert "angular momentum error" in text
    assert "day" in text


def test_methods_are_reported_by_the_name_that_was_asked_for():
    for name in ("stormer-verlet", "velocity-verlet"):
        sol = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.5, method=name, compile=False)
        assert sol.about.method == name
        assert f"{name}, order 2" in sol.report()


def test_errors_of_momenta_are_relative_to_those_of_the_bodies():
    """Of two bodies at rest in the mean the total is zero, or a rounding, which says nothing."""
    system = kd.systems.nbody([1.0, 3.0], [[1, 0, 0], [-1 / 3, 0, 0]], [[0, 0.9, 0], [0, -0.3, 0]])
    sol = kd.solve(system, (0.0, 10.0), step=0.01)
    assert sol.about.scales["momentum"] == pytest.approx(1.8)
    assert sol.about.scales["angular momentum"] == pytest.approx(1.2)
    error = np.linalg.norm(sol.invariants["momentum"] - sol.invariants["momentum"][0], axis=1).max()
    assert f"momentum error          {error / 1.8:.3e} relative, {error:.3e}" in sol.report()
    assert error / 1.8 < 1e-15


def test_the_report_of_a_function_without_energy_leaves_it_out():
    text = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.5, compile=False).report()
    assert "energy" not in text
    assert "force evaluations" in text


def test_units_are_those_that_pint_reads(planets):
    pytest.importorskip("pint_xarray")
    for system in (kd.systems.get(name) for name in kd.systems.catalogue()):
        sol = kd.solve(system, (0.0, 1.0), step=0.5)
        data = sol.to_xarray().pint.quantify()
        if " " not in system.units.get("v", ""):
            assert (
                str(data.v.pint.units or "") == {"au/day": "astronomical_unit / day", "": ""}[system.units.get("v", "")]
            )
    data = planets.to_xarray().pint.quantify()
    assert data.x.pint.to("km").pint.magnitude[0] == pytest.approx(planets.x[0] * 149597870.7)


def test_units_in_words_are_no_units(planets):
    data = kd.solve(kd.systems.benchmarks_game(), (0.0, 1.0), step=0.5).to_xarray()
    assert "units" not in data.v.attrs
    assert data.v.attrs["unit_in_words"] == kd.systems.benchmarks_game().units["v"]


def test_a_data_frame_has_a_row_a_time_and_names_its_columns(planets):
    pytest.importorskip("pandas")
    frame = planets.to_pandas()
    assert frame.index.name == "t"
    assert np.array_equal(frame.index, planets.t)
    assert np.array_equal(frame["x[Jupiter, y]"], planets.x[:, planets.about.coordinates["body"].index("Jupiter"), 1])
    assert np.array_equal(frame["energy"], planets.energy)
    assert np.array_equal(frame["angular momentum[2]"], planets.invariants["angular momentum"][:, 2])
    assert frame.attrs["units"]["v[Jupiter, z]"] == "au/day"
    assert frame.shape == (planets.t.size, planets.x[0].size * 2 + sum(v[0].size for v in planets.invariants.values()))
    scalar = kd.solve(kd.systems.pendulum(), (0.0, 1.0), step=0.1).to_pandas()
    assert list(scalar.columns) == ["x", "v", "energy"]
    plain = kd.solve(kd.FirstOrder(lambda y: -y), (0.0, 1.0), np.ones((2, 2)), step=0.5, compile=False).to_pandas()
    assert list(plain.columns) == ["x[0, 0]", "x[0, 1]", "x[1, 0]", "x[1, 1]"]


def test_without_pandas_the_error_names_the_extra(planets, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'kickdrift\[pandas\]'"):
        planets.to_pandas()
