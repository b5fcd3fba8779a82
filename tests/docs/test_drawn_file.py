"""Files of a page, and pictures of them."""

import pytest

from docs.generator.drawn_file import PICTURES, draw_file, pictures_html
from docs.generator.page_files import files_of
from docs.generator.places import DOCS

PAGE = """
```toml
# moves.toml
lengths = [1.0, 0.5, 1.0, 0.5]
```

```csv printed.csv
a
1
```

```console
$ bifurc list
```
"""


def test_files_are_named_by_a_comment_or_behind_their_language():
    files = files_of(PAGE)
    assert files["printed.csv"] == "a\n1\n"
    assert list(files) == ["moves.toml", "printed.csv"]
    with pytest.raises(ValueError, match="a block of json has no name"):
        files_of("```json\n{}\n```\n")


def test_a_picture_of_equations_is_drawn_where_the_page_shows_it(tmp_path):
    text = 'parameter = "p"\nequations = ["x^2 = p"]\n[unknowns]\nx = [-1, 1]\np = [-1, 1]\n'
    (path,) = draw_file("fold.toml", text, ["diagram"], tmp_path)
    assert path.read_text(encoding="utf-8").startswith("<?xml")
    assert f'src="there/{path.name}"' in pictures_html(
        "fold.toml", ["diagram"], "there"
    )


def test_every_file_that_is_drawn_stands_on_its_page():
    drawn = 0
    for page in DOCS.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        for line in text.splitlines():
            if line.startswith("```{drawn}"):
                name, *kinds = line.removeprefix("```{drawn}").split()
                assert name in files_of(text) and set(kinds) <= set(PICTURES), line
                drawn += 1
    assert drawn
