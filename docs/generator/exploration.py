"""Every linkage of the catalogue mapped, drawn and shown, as far as parameters or code
have changed since the last time."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from docs.generator.code_key import code_key, key_of
from docs.generator.linkage_record import LinkageRecord, record_linkage
from docs.generator.pictures import draw_linkage, drawing_of, map_of
from docs.generator.places import PICTURES, RECORDS, VIEWER
from linkages.catalogue import catalogue
from linkages.entry import Entry
from linkages.linkage import load
from linkages.mapping import map_linkage
from linkages.viewing.document import make_view_document
from linkages.viewing.page import write_page


def explore_catalogue() -> dict[str, LinkageRecord]:
    """The record of every linkage by its name, in the order of the catalogue; pictures
    and pages of the viewer are written to their folders."""
    entries = catalogue()
    outdated = [name for name, entry in entries.items() if not _is_current(entry)]
    _forget_others(entries)
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(_explore, outdated))
    return read_records()


def read_records() -> dict[str, LinkageRecord]:
    """The records that `explore_catalogue` wrote."""
    return {name: read_record(name) for name in catalogue()}


def read_record(name: str) -> LinkageRecord:
    """The record of one linkage."""
    return LinkageRecord.from_json(_read(name)["record"])


def _read(name: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(record_file(name).read_text(encoding="utf-8"))
    return content


def record_file(name: str) -> Path:
    """The file of the record of one linkage."""
    return RECORDS / f"{name}.json"


def _files_of(name: str) -> tuple[Path, ...]:
    """Everything that is written of a linkage besides its record."""
    page = VIEWER / f"{name}.html"
    return PICTURES / drawing_of(name), PICTURES / map_of(name), page


def _is_current(entry: Entry) -> bool:
    """Whether parameters and code are those of the record, and all files are there."""
    files = (record_file(entry.name), *_files_of(entry.name))
    if not all(path.exists() for path in files):
        return False
    return bool(_read(entry.name)["key"] == _key(entry))


def _key(entry: Entry) -> str:
    return key_of([code_key(), entry.name, repr(sorted(entry.defaults.items()))])


def _explore(name: str) -> str:
    """The name of a linkage that has been mapped; the record is written last, so that
    an interrupted run leaves no half of it."""
    entry = catalogue()[name]
    atlas = map_linkage(load(name))
    record = record_linkage(entry, atlas)
    draw_linkage(atlas, name, PICTURES)
    VIEWER.mkdir(parents=True, exist_ok=True)
    document = make_view_document(atlas, record.verdict)
    write_page(document, VIEWER / f"{name}.html")
    content = {"key": _key(entry), "record": record.to_json()}
    RECORDS.mkdir(parents=True, exist_ok=True)
    record_file(name).write_text(json.dumps(content), encoding="utf-8")
    return name


def _forget_others(entries: Mapping[str, Entry]) -> None:
    """Remove what was written of linkages that are no longer in the catalogue."""
    known = {record_file(name) for name in entries}
    for name in entries:
        known.update(_files_of(name))
    for folder in (RECORDS, PICTURES, VIEWER):
        for path in folder.glob("*"):
            if path not in known:
                path.unlink()
