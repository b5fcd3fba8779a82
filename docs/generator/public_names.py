"""Names in docstrings and annotations, which stand for where a thing is defined, lead
to the page under its public name."""

from __future__ import annotations

from functools import cache
from importlib import import_module

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

PACKAGES = ("bifurc", "linkages")


@cache
def _public() -> dict[str, str]:
    """Public names by the full names of what they stand for, and by their last part."""
    names: dict[str, str] = {}
    for package in map(import_module, PACKAGES):
        for name in package.__all__:
            public = f"{package.__name__}.{name}"
            thing = getattr(package, name)
            module = getattr(thing, "__module__", "")
            names[f"{module}.{name}"] = public
            names.setdefault(name, public)
    return names


def public_name(target: str) -> str | None:
    """The public name of what ``target`` stands for, itself or the class that it is a
    member of; None where that is not public."""
    if target in _public():
        return _public()[target]
    owner, _, member = target.rpartition(".")
    if owner in _public():
        return f"{_public()[owner]}.{member}"
    return None


def _resolve(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, contnode: nodes.Element
) -> nodes.reference | None:
    """The link to a public name, where Sphinx found none."""
    if node.get("refdomain") != "py":
        return None
    public = public_name(node["reftarget"])
    if public is None or public == node["reftarget"]:
        return None
    domain = env.domains["py"]
    return domain.resolve_xref(
        env, node["refdoc"], app.builder, "obj", public, node, contnode
    )


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to what Sphinx could not resolve."""
    app.connect("missing-reference", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
