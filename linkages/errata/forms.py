"""Closed forms as printed, against the corrected ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.closed_form import ClosedForm
from linkages.closed_forms.form_table import (
    FormTable,
    changed,
    closed_form,
    form_tables,
)
from linkages.errata.erratum import Amounts, median_and_largest

INPUTS = 60  # input angles along a form


def compare_closed_forms(linkage: str, number: int, printed: FormTable) -> Amounts:
    """Amounts for the closed form ``number`` of a linkage with what is ``printed`` in
    place of the entries of its table, and for the form as it is."""
    owner = entry(linkage)
    form = owner.closed_forms[number]
    table = form_tables(owner.family)[linkage][number]
    misprint = closed_form(linkage, changed(table, printed))
    parameters = owner.defaults
    rng = np.random.default_rng(0)
    while True:
        of_print = _defects(misprint, parameters)
        corrected = _defects(form, parameters)
        if len(of_print) and len(corrected):
            return median_and_largest(of_print, corrected)
        parameters = owner.draw(rng)  # no real configuration


def _defects(form: ClosedForm, parameters: Mapping[str, float]) -> np.ndarray:
    """Closure defects along the form, at all inputs and both roots."""
    loop = entry(form.linkage).build(**parameters)
    inputs = np.linspace(-3.0, 3.0, INPUTS)
    paths = [form.configurations(inputs, parameters, root) for root in form.roots]
    theta = np.concatenate(paths)
    theta = theta[np.isfinite(theta).all(axis=1)]
    product = loop.frames(theta)[:, -1]
    gap = np.abs(product - np.eye(4))
    gap[:, :3, 3] /= loop.characteristic_length
    return np.asarray(gap.max(axis=(1, 2)))
