"""The table of joint angles: every digit, and no jumps."""

import csv
import io

import numpy as np

from linkages.export.model import make_angle_table, motion_of_form
from linkages.linkage import load
from linkages.mapping import map_linkage


def test_the_table_holds_the_form_at_even_arclengths():
    atlas = map_linkage(load("bennett"))
    form = atlas.forms[0]
    motion = motion_of_form(form, 50)
    text = make_angle_table(motion.arclength, motion.configurations, atlas.names)
    head, *lines = text.splitlines()
    assert head == "arclength,theta1,theta2,theta3,theta4"
    rows = np.loadtxt(io.StringIO("\n".join(lines)), delimiter=",")
    assert rows.shape == (50, 5)
    assert np.array_equal(rows[:, 0], np.linspace(0, form.branch.length, 50))
    assert np.array_equal(rows[:, 1:], form.branch(rows[:, 0]))
    assert np.abs(np.diff(rows[:, 1:], axis=0)).max() < 0.3


def test_names_with_commas_and_quotes_stay_one_cell():
    text = make_angle_table(np.zeros(1), np.zeros((1, 2)), ['a,"b"', "c"])
    (head, _) = csv.reader(io.StringIO(text))
    assert head == ["arclength", 'a,"b"', "c"]


def test_a_joint_called_as_the_first_column_is_told_apart_from_it():
    text = make_angle_table(np.zeros(1), np.zeros((1, 1)), ["Arclength"])
    assert text.splitlines()[0] == "arclength,Arclength (unknown)"
