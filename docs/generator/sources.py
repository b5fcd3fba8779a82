"""Everything that Sphinx reads, put together in one folder: the pages of docs/, and
those that are made."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from types import ModuleType

from docs.generator.code_key import code_key
from docs.generator.errata_pages import errata_index, errata_pages
from docs.generator.exploration import explore_catalogue
from docs.generator.linkage_page import linkage_page
from docs.generator.linkage_record import LinkageRecord
from docs.generator.markdown import plain
from docs.generator.pictures import draw_no_picture
from docs.generator.places import DOCS, NO_PICTURE, ROOT, SCRIPTS, SOURCE
from docs.generator.study_scripts import HEADER, gallery_script, study_names
from docs.generator.text_files import keep_only, remove_folder, write_texts
from linkages.catalogue import catalogue, families

STUDIES = "studies"  # below the sources: what sphinx-gallery writes
API = "reference/api"  # below the sources: what autosummary writes
KEY = "code.key"  # below the sources: of the code that the studies were run with


def gather_sources() -> None:
    """Write all pages below `SOURCE`, and the studies to `SCRIPTS`; what has not
    changed is left alone."""
    pages = written_pages()
    pages |= made_errata(pages["errata.md"])
    pages |= family_pages()
    pages |= linkage_pages(explore_catalogue())
    pages["catalogue.md"] += families_toctree()
    keep_only(SOURCE, set(pages), besides=frozenset({STUDIES, API, KEY}))
    write_texts(SOURCE, pages)
    _gather_studies()


def written_pages() -> dict[str, str]:
    """The pages that are written by hand, by their paths below `SOURCE`."""
    pages = {
        path.relative_to(DOCS).as_posix(): path.read_text(encoding="utf-8")
        for path in DOCS.rglob("*.md")
    }
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return {**pages, "changes.md": changes}


def made_errata(page: str) -> dict[str, str]:
    """The misprints, a page a source, and the page that lists these."""
    sources = errata_pages(page)
    texts = {f"errata/{one.name}.md": one.markdown() for one in sources}
    return {**texts, "errata.md": errata_index(page, sources)}


def linkage_pages(records: Mapping[str, LinkageRecord]) -> dict[str, str]:
    """A page for each linkage."""
    return {
        f"linkages/{name}.md": linkage_page(entry, records[name])
        for name, entry in catalogue().items()
    }


def family_pages() -> dict[str, str]:
    """A page for each family, which lists its linkages."""
    return {f"{_family_path(family)}.md": _family_page(family) for family in families()}


def families_toctree() -> str:
    """The families in the order of the catalogue, for the sidebar."""
    lines = [f"{_family_title(one)[0]} <{_family_path(one)}>" for one in families()]
    return _hidden_toctree(lines)


def _family_path(family: ModuleType) -> str:
    return f"families/{family.__name__.rpartition('.')[2]}"


def _family_title(family: ModuleType) -> tuple[str, str]:
    """The title of a family, and what its docstring says besides in one sentence."""
    words = " ".join((family.__doc__ or "").split("\n\n")[0].split())
    title, *rest = re.split("[:,] ", words, maxsplit=1)
    return title.rstrip("."), "".join(rest)


def _family_page(family: ModuleType) -> str:
    title, rest = _family_title(family)
    names = [entry.name for entry in family.ENTRIES]
    sentence = f"{rest[0].upper()}{rest[1:]}" if rest else ""
    parts = [
        f"# {plain(title)}",
        plain(sentence),
        f"```{{linkage-gallery}} {' '.join(names)}\n```",
    ]
    text = "\n\n".join(part for part in parts if part)
    return text + _hidden_toctree(f"{name} </linkages/{name}>" for name in names)


def _hidden_toctree(lines: Iterable[str]) -> str:
    names = "\n".join(lines)
    return f"\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n"


def _gather_studies() -> None:
    """Write the scripts; where any code has changed, what the gallery made of them is
    forgotten, as it knows of the scripts alone."""
    scripts = {f"{name}.py": gallery_script(name) for name in study_names()}
    scripts["GALLERY_HEADER.rst"] = HEADER
    draw_no_picture(NO_PICTURE)
    keep_only(SCRIPTS, set(scripts), besides=frozenset({"out"}))
    write_texts(SCRIPTS, scripts)
    key = SOURCE / KEY
    if not key.exists() or key.read_text(encoding="utf-8") != code_key():
        remove_folder(SOURCE / STUDIES)
        key.write_text(code_key(), encoding="utf-8")
