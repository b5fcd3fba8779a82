"""Datasets and files: what is stored comes back identical, and what is no atlas is
refused by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import networkx as nx
import numpy as np
import pytest

from bifurc.atlas import Atlas, Event, Surface
from bifurc.files.dataset import (
    AtlasFileError,
    from_dataset,
    load_atlas,
    save_atlas,
    to_dataset,
)
from bifurc.files.graphml import write_graphml
from bifurc.files.json_values import from_text, to_text
from bifurc.function_problem import FunctionProblem
from bifurc.graphs import arc_graph, transition_graph
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings


def difference(a: Any, b: Any, where: str = "atlas") -> str:
    """The first place where two nestings of records, arrays and plain values differ in
    type or by one bit."""
    if type(a) is not type(b):
        return f"{where}: {type(a)} and {type(b)}"
    if is_dataclass(a):
        parts = [
            (f".{f.name}", getattr(a, f.name), getattr(b, f.name)) for f in fields(a)
        ]
    elif isinstance(a, np.ndarray):
        alike = a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        return "" if alike else f"{where}: {a!r} and {b!r}"
    elif isinstance(a, tuple | list):
        if len(a) != len(b):
            return f"{where}: {len(a)} and {len(b)} entries"
        parts = [(f"[{i}]", x, y) for i, (x, y) in enumerate(zip(a, b, strict=True))]
    elif isinstance(a, Mapping):
        if list(a) != list(b):
            return f"{where}: keys {list(a)} and {list(b)}"
        parts = [(f"[{key!r}]", a[key], b[key]) for key in a]
    else:
        return "" if a == b else f"{where}: {a!r} and {b!r}"
    return next(
        (found for name, x, y in parts if (found := difference(x, y, where + name))), ""
    )


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """Two lines that cross on a torus and in a box: a closed and an open form, with
    everything an atlas can hold."""
    problem = FunctionProblem(
        lambda u: np.array([np.sin(u[0]) * np.sin(u[1])]),
        [[-np.inf, np.inf], [-2.0, 2.0]],
        names=("x", "y"),
        units=("rad", "rad"),
        periods=(2 * np.pi, np.inf),
    )
    found = explore(problem, settings=SearchSettings(starts=40))
    assert {form.branch.closed for form in found.forms} == {True, False}
    label = {
        "inactive": ("x",),
        "at": np.pi / 3,
        "fixed": {1: np.float64(0.1)},
        "free": [None, True],
    }
    named = found.renamed(
        [f"Form {chr(945 + i)}, no. {i}" for i in range(3)],
        [label, {}, {"symmetry": "none"}],
    )
    linkage = {
        "name": "a pair",
        "lengths": [1.0, 0.1 + 0.2],
        "twists": np.array([0.1, -0.0]),
        "offsets": (0, 1),
    }
    return replace(
        named,
        rigid=np.array([[0.1, 1 / 3]]),
        closure_gap=1e-300,
        subject=linkage,
        near_misses=(Event(2, 1 / 3, np.array([0.1, 0.7]), value=1e-5),),
        dead_points=(
            Event(0, 2 / 3, np.array([0.3, -0.0]), index=1),
            Event(1, 0.0, np.zeros(2), index=0),
        ),
        surfaces=(
            Surface(2, np.eye(2), note="not all of it"),
            Surface(3, np.ones((3, 2)) / 7),
        ),
    )


def test_a_dataset_gives_back_the_identical_atlas(atlas: Atlas) -> None:
    assert difference(from_dataset(to_dataset(atlas)), atlas) == ""


def test_a_file_gives_back_the_identical_atlas(atlas: Atlas, tmp_path) -> None:
    assert difference(load_atlas(save_atlas(atlas, tmp_path / "atlas.nc")), atlas) == ""


def test_an_atlas_without_any_solution_comes_back_identical(tmp_path) -> None:
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
    assert attributes["version"] and attributes["derivatives"] == "complex step"


def test_the_linkage_is_stored_along_the_joints(atlas: Atlas) -> None:
    dataset = to_dataset(atlas)
    assert dataset.attrs["linkage_name"] == "a pair"
    assert dataset["linkage_lengths"].dims == ("joint",)
    np.testing.assert_array_equal(dataset["linkage_lengths"], [1.0, 0.1 + 0.2])


def test_unknowns_of_mixed_units_have_a_dimension_of_their_own(
    atlas: Atlas, tmp_path
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
    import xarray as xr

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
        AtlasFileError, match=r"old\.nc: its format version is 1; this release reads 3"
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
    import xarray as xr

    path = save_atlas(atlas, tmp_path / "atlas.nc")
    before = path.read_bytes()

    def interrupted(self: xr.Dataset, target: Any, **options: Any) -> None:
        target.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(xr.Dataset, "to_netcdf", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save_atlas(atlas, path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_a_folder_that_does_not_exist_is_named(atlas: Atlas, tmp_path) -> None:
    with pytest.raises(NotADirectoryError, match="nowhere"):
        save_atlas(atlas, tmp_path / "nowhere" / "atlas.nc")


def test_text_keeps_types_and_every_digit() -> None:
    value = {
        "a": (1, 2.5, [True, None]),
        "b": np.array([[0.1, np.inf]]),
        3: np.int64(4),
        "nan": np.array(["x", "yz"]),
        "__kind__": {"deep": (np.float64(0.1),)},
        "empty": np.empty((0, 3)),
    }
    assert difference(from_text(to_text(value)), value) == ""


def test_text_refuses_what_it_cannot_give_back() -> None:
    with pytest.raises(TypeError, match="type set cannot be stored"):
        to_text({"a": {1, 2}})


def test_graphml_holds_both_graphs_with_plain_attributes(
    atlas: Atlas, tmp_path
) -> None:
    graph = nx.read_graphml(
        write_graphml(atlas, tmp_path / "graph.graphml"), force_multigraph=True
    )
    layers = {
        layer: graph.edge_subgraph(
            (a, b, k)
            for a, b, k, e in graph.edges(keys=True, data="layer")
            if e == layer
        )
        for layer in ("forms", "arcs")
    }
    assert (
        layers["forms"].number_of_edges() == transition_graph(atlas).number_of_edges()
    )
    assert layers["arcs"].number_of_edges() == arc_graph(atlas).number_of_edges()
    total = sum(length for *_, length in layers["arcs"].edges(data="length"))
    assert total == pytest.approx(sum(form.branch.length for form in atlas.forms))
    assert all("travel_x" in edge for *_, edge in layers["arcs"].edges(data=True))
