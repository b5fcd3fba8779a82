"""Links of a loop in space, by which drawings of them are tested."""

import numpy as np

from linkages.links.rods import link_corners
from linkages.loop import Loop


def place_links(loop: Loop, theta: np.ndarray) -> np.ndarray:
    """The corners (..., n, 4, 3) of all links at joint angles (..., n), rad, in the
    frame of the link that joins the last joint to the first."""
    frames = loop.frames(theta)[..., 1:, :, :]
    turned = np.einsum("...irk,ick->...icr", frames[..., :3, :3], link_corners(loop))
    placed: np.ndarray = turned + frames[..., None, :3, 3]
    return placed
