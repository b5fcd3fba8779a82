"""Datasets and files: what is stored comes back identical, and what is no atlas is
refused by name."""

from __future__ import annotations

import errno
from dataclasses import replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from bifurc.atlas import Atlas
from bifurc.files.dataset import (
    AtlasFileError,
    from_dataset,
    load_atlas,
    save_atlas,
    to_dataset,
)
from bifurc.files.netcdf import MARK
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


def test_a_dataset_gives_back_the_identical_atlas(atlas: Atlas, difference) -> None:
    assert difference(from_dataset(to_dataset(atlas)), atlas) == ""


def test_a_file_gives_back_the_identical_atlas(
    atlas: Atlas, tmp_path, difference
) -> None:
    assert difference(load_atlas(save_atlas(atlas, tmp_path / "atlas.nc")), atlas) == ""


def test_an_atlas_without_any_solution_comes_back_identical(
    tmp_path, difference
) -> None:
    nothing = explore(
        FunctionProblem(
            lambda u: np.array([u[0] ** 2 + u[1] ** 2 + 1]), [[-1, 1], [-1, 1]]
        ),
        settings=SearchSettings(starts=5),
    )
    assert not nothing.forms and nothing.closure_gap > 0
    assert (
        difference(load_atlas(save_atlas(nothing, tmp_path / "none.nc")), nothing) == ""
    )


def test_samples_lie_on_the_forms_and_keep_their_singular_values(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    assert dataset["configuration"].dims == ("form", "sample", "joint")
    assert dataset["singular_values"].dims == ("form", "sample", "singular_value")
    for form in atlas.forms:
        at = dataset.sel(form=form.name).dropna(
            "sample", how="all", subset=["arclength"]
        )
        np.testing.assert_array_equal(
            at["configuration"], form.branch(at["arclength"].values)
        )
        assert (
            at["singular_values"].values[:, form.rank - 1].min()
            >= form.min_singular_value
        )


def test_every_variable_has_a_long_name_and_angles_have_units(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    assert all(
        "long_name" in dataset[name].attrs
        for name in dataset.data_vars
        if not name.startswith("linkage")
    )
    assert dataset["configuration"].attrs["units"] == "rad"


def test_the_provenance_is_in_the_attributes(atlas: Atlas) -> None:
    attributes = to_dataset(atlas).attrs
    assert (
        attributes["seed"] == 0
        and attributes["settings_tolerance"]
        == atlas.provenance.settings.tracing.tolerance
    )
    assert attributes["version"] and attributes["derivatives"] == "recorded"


def test_the_setting_of_the_count_is_read_by_its_older_name(
    atlas: Atlas, tmp_path
) -> None:
    path = save_atlas(atlas, tmp_path / "older.nc")
    older = xr.load_dataset(path)
    provenance = older.attrs["provenance"]
    assert '"count"' in provenance
    older.attrs["provenance"] = provenance.replace('"count"', '"prove"')
    older.attrs.pop("checksum", None)
    older.to_netcdf(tmp_path / "older2.nc")
    found = load_atlas(tmp_path / "older2.nc")
    assert found.provenance.settings == atlas.provenance.settings


def test_the_linkage_is_stored_along_the_joints(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    assert dataset.attrs["linkage_name"] == "a pair"
    assert dataset["linkage_lengths"].dims == ("joint",)
    np.testing.assert_array_equal(dataset["linkage_lengths"], [1.0, 0.1 + 0.2])


def test_unknowns_of_mixed_units_have_a_dimension_of_their_own(
    atlas: Atlas, tmp_path, difference
) -> None:
    mixed = replace(atlas, units=("rad", "seconds"))
    dataset = to_dataset(mixed)
    assert "unknown" in dataset.dims and "joint" not in dataset.dims
    assert difference(load_atlas(save_atlas(mixed, tmp_path / "mixed.nc")), mixed) == ""


def test_a_missing_variable_is_named_with_the_file(atlas: Atlas, tmp_path) -> None:
    path = tmp_path / "torn.nc"
    to_dataset(atlas).drop_vars(["coefficient", "pass_form"]).to_netcdf(path)
    with pytest.raises(
        AtlasFileError, match=r"torn\.nc: it lacks .*coefficient.*pass_form"
    ) as caught:
        load_atlas(path)
    assert set(caught.value.missing) == {"coefficient", "pass_form"}


def test_a_netcdf_file_of_something_else_is_refused(tmp_path) -> None:
    xr.Dataset({"rain": ("time", [1.0])}).to_netcdf(tmp_path / "rain.nc")
    with pytest.raises(
        AtlasFileError, match=r"rain\.nc: its attribute 'format' is None"
    ):
        load_atlas(tmp_path / "rain.nc")


def test_a_file_of_an_older_layout_is_refused_with_both_versions(
    atlas: Atlas, tmp_path
) -> None:
    dataset = to_dataset(atlas)
    dataset.attrs["format_version"] = 1
    dataset.to_netcdf(tmp_path / "old.nc")
    with pytest.raises(
        AtlasFileError, match=r"old\.nc: its format version is 1; this release reads 11"
    ):
        load_atlas(tmp_path / "old.nc")


def test_a_file_that_is_not_netcdf_is_refused_by_name(tmp_path) -> None:
    (tmp_path / "text.nc").write_text("no atlas")
    with pytest.raises(AtlasFileError, match=r"text\.nc: it cannot be read as NetCDF"):
        load_atlas(tmp_path / "text.nc")
    with pytest.raises(FileNotFoundError, match=r"none\.nc"):
        load_atlas(tmp_path / "none.nc")


def test_an_interrupted_run_leaves_the_old_file_and_nothing_else(
    atlas: Atlas, tmp_path, monkeypatch
) -> None:
    path = save_atlas(atlas, tmp_path / "atlas.nc")
    before = path.read_bytes()

    def interrupted(target: Path, *content: object) -> None:
        target.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr("bifurc.files.dataset.write_netcdf", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save_atlas(atlas, path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_a_folder_that_does_not_exist_is_named(atlas: Atlas, tmp_path) -> None:
    with pytest.raises(NotADirectoryError, match="nowhere"):
        save_atlas(atlas, tmp_path / "nowhere" / "atlas.nc")


# --- damage ---------------------------------------------------------------------------


def test_a_folder_or_a_device_is_no_atlas(tmp_path) -> None:
    for path in (tmp_path, Path("/dev/full")):
        with pytest.raises(AtlasFileError, match="it is a folder or a device"):
            load_atlas(path)


@pytest.fixture(scope="module")
def content(atlas: Atlas, tmp_path_factory) -> bytes:
    """The bytes of a whole file."""
    return save_atlas(atlas, tmp_path_factory.mktemp("whole") / "a.nc").read_bytes()


@pytest.mark.parametrize("count", [1, 20])
def test_a_file_with_wrong_bytes_is_refused_or_gives_the_same_atlas(
    atlas: Atlas, content: bytes, tmp_path, difference, count: int
) -> None:
    """Where the bytes mean nothing, such as between two variables, it is whole."""
    path = tmp_path / "damaged.nc"
    refused = 0
    for seed in range(50):
        rng = np.random.default_rng(seed)
        damaged = np.frombuffer(content, dtype=np.uint8).copy()
        places = rng.integers(len(damaged), size=count)
        damaged[places] ^= rng.integers(1, 256, size=count, dtype=np.uint8)
        path.write_bytes(damaged.tobytes())
        try:
            assert difference(load_atlas(path), atlas) == ""
        except AtlasFileError as error:
            assert error.source == str(path)
            refused += 1
    assert refused > 10


def test_the_libraries_are_not_asked_to_read_a_file_with_wrong_bytes(
    content: bytes, tmp_path, monkeypatch
) -> None:
    """They may crash on it."""
    path = tmp_path / "damaged.nc"
    path.write_bytes(content[:1000] + bytes([content[1000] ^ 1]) + content[1001:])
    monkeypatch.delattr(xr, "open_dataset")
    with pytest.raises(AtlasFileError, match="the file is damaged"):
        load_atlas(path)


def test_a_file_that_another_program_has_written_on_is_read(
    atlas: Atlas, content: bytes, tmp_path
) -> None:
    path = tmp_path / "a.nc"
    path.write_bytes(content)
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("comment", "for the archive")
    assert len(load_atlas(path).forms) == len(atlas.forms)


def test_a_truncated_file_is_refused(content: bytes, tmp_path) -> None:
    path = tmp_path / "short.nc"
    data = content.index(MARK)
    for length in np.linspace(0, data - 1, 30, dtype=int):
        path.write_bytes(content[:length])
        with pytest.raises(AtlasFileError, match=r"short\.nc: it cannot be read"):
            load_atlas(path)


def test_a_file_with_other_values_is_read_once_its_checksum_is_deleted(
    atlas: Atlas, tmp_path
) -> None:
    path = save_atlas(atlas, tmp_path / "a.nc")
    dataset = xr.load_dataset(path)
    dataset["dead_point_arclength"][0] = 0.25
    dataset.to_netcdf(tmp_path / "edited.nc")
    with pytest.raises(AtlasFileError, match="was edited"):
        load_atlas(tmp_path / "edited.nc")
    del dataset.attrs["checksum"]
    dataset.to_netcdf(tmp_path / "edited.nc")
    assert load_atlas(tmp_path / "edited.nc").dead_points[0].s == 0.25


def shortened(variable: xr.Variable) -> xr.Variable:
    return xr.Variable(variable.dims[1:], np.zeros(variable.shape[1:], variable.dtype))


def renamed(variable: xr.Variable) -> xr.Variable:
    return xr.Variable([f"other_{name}" for name in variable.dims], variable.values)


def as_text(variable: xr.Variable) -> xr.Variable:
    return xr.Variable(variable.dims, np.full(variable.shape, "text"))


def as_number(variable: xr.Variable) -> xr.Variable:
    return xr.Variable(variable.dims, np.zeros(variable.shape))


def as_complex(variable: xr.Variable) -> xr.Variable:
    return xr.Variable(variable.dims, np.zeros(variable.shape, dtype=complex))


@pytest.mark.parametrize("damage", [shortened, renamed, as_text, as_number, as_complex])
def test_a_variable_of_a_wrong_shape_or_type_is_named(atlas: Atlas, damage) -> None:
    whole = to_dataset(atlas)
    count = 0
    for name, array in whole.data_vars.items():
        variable = damage(array.variable)
        same_kind = variable.dtype.kind == array.dtype.kind
        is_damaged = variable.dims != array.dims or not same_kind
        if str(name).startswith("linkage") or not is_damaged:
            continue
        count += 1
        with pytest.raises(AtlasFileError, match=f"dataset: {name} "):
            from_dataset(whole.assign({name: variable}))
    assert count > 20


def test_every_missing_variable_is_named(atlas: Atlas) -> None:
    whole = to_dataset(atlas)
    for name in whole.variables:
        if not str(name).startswith("linkage"):
            with pytest.raises(AtlasFileError, match="it lacks") as caught:
                from_dataset(whole.drop_vars(str(name)))
            assert caught.value.missing == (name,)


@pytest.mark.parametrize(
    "name", ["piece_count", "pass_count", "sample_count", "corner_count"]
)
@pytest.mark.parametrize("number", [-1, 10**9])
def test_numbers_of_entries_that_cannot_be_are_refused(
    atlas: Atlas, name: str, number: int
) -> None:
    dataset = to_dataset(atlas)
    dataset[name][0] = number
    with pytest.raises(AtlasFileError, match=f"{name} holds a number that is not"):
        from_dataset(dataset)


def test_numbers_of_entries_that_do_not_add_up_are_refused(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    dataset["piece_count"][0] -= 1
    with pytest.raises(AtlasFileError, match="piece_count adds up to"):
        from_dataset(dataset)


@pytest.mark.parametrize(
    "name",
    [
        "pass_form",
        "near_miss_form",
        "dead_point_form",
        "dead_point_index",
        "chart_pair",
        "polygon_corner",
    ],
)
@pytest.mark.parametrize("index", [-1, 1000])
def test_indices_of_nothing_are_refused(atlas: Atlas, name: str, index: int) -> None:
    dataset = to_dataset(atlas)
    dataset[name][(0,) * dataset[name].ndim] = index
    with pytest.raises(AtlasFileError, match=f"{name} holds an index"):
        from_dataset(dataset)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("outcome", "LOST"),
        ("point_kind", "?"),
        ("covering", "?"),
        ("labels", "{"),
        ("labels", "[1]"),
        ("certificate", "{}"),
        ("sample_nodes", 10007),
        ("sample_nodes", 0),
        ("polygon_size", 5),
    ],
)
def test_values_that_do_not_fit_together_are_refused(
    atlas: Atlas, name: str, value: str | int
) -> None:
    dataset = to_dataset(atlas)
    values = dataset[name].values.astype(object if isinstance(value, str) else int)
    values[0] = value
    dataset[name] = (dataset[name].dims, values)
    with pytest.raises(AtlasFileError, match="does not fit together"):
        from_dataset(dataset)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("format", 3),
        ("format", np.array([1.0, 2.0])),
        ("format_version", "three"),
        ("format_version", np.array([3, 3])),
        ("unknown_dimension", "nowhere"),
        ("unknown_dimension", 1.0),
        ("closure_gap", "small"),
        ("completeness", "{}"),
        ("completeness", '{"claims": [], "doubts": [1], "missed_probability": 0.1}'),
        ("filled_dimensions", "joint"),
        ("filled_dimensions", 1.0),
        ("provenance", "{"),
        ("provenance", "{}"),
        ("provenance", '{"settings": 1}'),
        ("provenance", '{"settings": {"tracing": {"order": "x"}}}'),
        ("provenance", '{"settings": {"tracing": {}, "starts": -1}}'),
        ("provenance", '{"settings": {"tracing": {}}, "colour": 1}'),
        ("subject", "[1]"),
        ("subject", 1.0),
    ],
)
def test_an_attribute_of_a_wrong_kind_is_refused(
    atlas: Atlas, name: str, value: object
) -> None:
    dataset = to_dataset(atlas)
    dataset.attrs[name] = value
    with pytest.raises(AtlasFileError):
        from_dataset(dataset)


def test_every_missing_attribute_that_is_read_is_named(atlas: Atlas) -> None:
    for name in ("closure_gap", "provenance", "subject", "completeness"):
        dataset = to_dataset(atlas)
        del dataset.attrs[name]
        with pytest.raises(AtlasFileError, match=f"it lacks {name}"):
            from_dataset(dataset)


def test_a_dataset_has_no_variable_that_its_atlas_does_not_fill(difference) -> None:
    circle = FunctionProblem(lambda u: [u @ u - 1.0], [(-2.0, 2.0)] * 2)
    atlas = explore(circle)
    dataset = to_dataset(atlas)
    assert {"form", "sample", "piece"} <= set(dataset.dims)
    assert not {"point", "near_miss", "surface", "assembly"} & set(dataset.dims)
    assert all(variable.size for variable in dataset.variables.values())
    assert difference(from_dataset(dataset), atlas) == ""


def test_what_is_left_out_of_a_dataset_is_not_lost_in_silence(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    filled = dataset.attrs["filled_dimensions"].split()
    filled.remove("point")
    dataset.attrs["filled_dimensions"] = " ".join(filled)
    with pytest.raises(AtlasFileError, match="'filled_dimensions' leaves out"):
        from_dataset(dataset)


# --- writing --------------------------------------------------------------------------


def test_a_disk_that_is_full_for_netcdf_is_told_with_the_name_of_the_file(
    atlas: Atlas, tmp_path, monkeypatch
) -> None:
    path = save_atlas(atlas, tmp_path / "atlas.nc")
    before = path.read_bytes()

    def full(*arguments: object) -> None:
        raise RuntimeError("NetCDF: HDF error")

    monkeypatch.setattr("bifurc.files.netcdf._write_variable", full)
    with pytest.raises(OSError, match=r"cannot be written.*atlas\.nc") as caught:
        save_atlas(atlas, path)
    assert caught.value.errno == errno.EIO
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_has_the_layout_that_xarray_gives_to_the_dataset(
    atlas: Atlas, tmp_path
) -> None:
    save_atlas(atlas, tmp_path / "ours.nc")
    to_dataset(atlas).to_netcdf(tmp_path / "theirs.nc", engine="netcdf4")
    with (
        netCDF4.Dataset(tmp_path / "ours.nc") as ours,
        netCDF4.Dataset(tmp_path / "theirs.nc") as theirs,
    ):
        assert set(ours.variables) == set(theirs.variables)
        assert set(theirs.ncattrs()) < set(ours.ncattrs())
        for name in theirs.variables:
            assert layout(ours[name]) == layout(theirs[name])
            np.testing.assert_array_equal(ours[name][...], theirs[name][...])
        for name in theirs.ncattrs():
            assert type(ours.getncattr(name)) is type(theirs.getncattr(name))


def layout(variable: netCDF4.Variable) -> tuple[object, ...]:
    attributes = {name: variable.getncattr(name) for name in variable.ncattrs()}
    return variable.dtype, variable.dimensions, variable.shape, attributes


def test_a_folder_in_place_of_the_file_is_named(atlas: Atlas, tmp_path) -> None:
    with pytest.raises(IsADirectoryError, match=str(tmp_path)):
        save_atlas(atlas, tmp_path)
