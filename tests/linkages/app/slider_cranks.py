"""Slider-cranks as files: a crank on the origin, a rod, and a slide along x."""


def slider_crank_text(elbow, slider, first="J1", last="J4"):
    """The elbow is at a point (2,), the slider at so much on x; ``first`` and ``last``
    are the names of the joints on the frame."""
    x, y = elbow
    turns = [
        (first, "frame", "crank", (0, 0)),
        ("J2", "crank", "rod", (x, y)),
        ("J3", "rod", "slider", (slider, 0)),
    ]
    text = 'name = "slider-crank"\n'
    for name, body, other, place in turns:
        text += f'[[joints]]\nname = "{name}"\nkind = "revolute"\n'
        text += f'bodies = ["{body}", "{other}"]\n'
        text += f"point = [{place[0]}, {place[1]}, 0]\ndirection = [0, 0, 1]\n"
    text += f'[[joints]]\nname = "{last}"\nkind = "prismatic"\n'
    return text + 'bodies = ["frame", "slider"]\ndirection = [1, 0, 0]\n'
