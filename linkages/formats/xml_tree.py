"""XML elements with their lines, of files without entities."""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from linkages.mechanisms.origin import WrittenNumber
from linkages.values import GeometryError, check_number, quoted, require

DEEPEST = 500  # elements inside each other


@dataclass
class Element:
    """An element: its ``tag``, ``attributes``, ``text`` and ``children``, and the
    ``line`` that it begins on."""

    tag: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    text: str = ""
    children: list[Element] = field(default_factory=list)

    @property
    def place(self) -> str:
        """The element as error messages name it."""
        name = self.attributes.get("name")
        shown = f'<{self.tag} name="{name}">' if name else f"<{self.tag}>"
        return f"{shown} on line {self.line}"

    def all(self, *tags: str) -> Iterator[Element]:
        """The children with one of these tags."""
        return (child for child in self.children if child.tag in tags)

    def first(self, tag: str) -> Element | None:
        """The first child with this tag, if there is one."""
        return next(self.all(tag), None)

    def refuse(self, attribute: str, value: object, allowed: str) -> NoReturn:
        """Raise `GeometryError` for an attribute, or the text, of this element."""
        raise GeometryError(f"{attribute} of {self.place}", value, allowed)

    def require(
        self, is_met: bool, attribute: str, value: object, allowed: str
    ) -> None:
        """Raise as `refuse` unless what must be ``is_met``."""
        if not is_met:
            self.refuse(attribute, value, allowed)

    def numbers(self, attribute: str, counts: tuple[int, ...]) -> list[float] | None:
        """The numbers of an attribute; None where there is none. Raises
        `GeometryError` unless there are so many, or one of so many."""
        text = self.attributes.get(attribute)
        if text is None:
            return None
        return self.parsed_numbers(attribute, text, counts)

    def parsed_numbers(
        self, what: str, text: str, counts: tuple[int, ...]
    ) -> list[float]:
        """The numbers of a text, which know their decimals; raises `GeometryError`
        unless there are so many."""
        allowed = f"{' or '.join(str(count) for count in counts)} numbers"
        if counts == (1,):
            allowed = "a number"
        try:
            numbers: list[float] = [WrittenNumber(word) for word in text.split()]
        except ValueError:
            self.refuse(what, quoted(text), allowed)
        self.require(len(numbers) in counts, what, quoted(text), allowed)
        for number in numbers:
            check_number(f"{what} of {self.place}", number)
        return numbers

    def choice(self, attribute: str, allowed: tuple[str, ...], default: str) -> str:
        """The value of an attribute that is one of some words; raises
        `GeometryError`."""
        value = self.attributes.get(attribute, default)
        words = f"one of {', '.join(allowed)}"
        self.require(value in allowed, attribute, quoted(value), words)
        return value

    def reference(
        self, attribute: str, known: Container[str], allowed: str, default: str = ""
    ) -> str:
        """The name of something ``known``; raises `GeometryError`."""
        name = self.attributes.get(attribute, default or None)
        if name is None or name not in known:
            shown = "missing" if name is None else quoted(name)
            self.refuse(attribute, shown, allowed)
        return name

    def check_new(self, name: str, known: Container[str]) -> None:
        """Raise `GeometryError` where the ``name`` of this element is known."""
        self.require(name not in known, "name", quoted(name), "given once")


def parse_xml(content: bytes) -> Element:
    """The first element of a document.

    A document type that declares anything is refused, and so is every entity that a
    file could define. Raises `GeometryError` with the line.
    """
    parser = expat.ParserCreate()
    document = Element("", 0)
    open_elements = [document]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, parser.CurrentLineNumber, attributes)
        open_elements[-1].children.append(element)
        open_elements.append(element)
        is_near = len(open_elements) - 1 <= DEEPEST
        allowed = f"at most {DEEPEST} elements inside each other"
        require(is_near, f"line {element.line}", f"<{tag}>", allowed)

    def add_text(text: str) -> None:
        open_elements[-1].text += text

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: open_elements.pop()
    parser.CharacterDataHandler = add_text
    _refuse_entities(parser)
    parser.buffer_text = True
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        what = f"line {error.lineno}, column {error.offset + 1}"
        raise GeometryError(what, reason, "well-formed XML") from None
    except (ValueError, LookupError) as error:  # an encoding that expat does not know
        if isinstance(error, GeometryError):
            raise
        raise GeometryError("encoding", error, "UTF-8") from None
    return document.children[0]


def _refuse_entities(parser: expat.XMLParserType) -> None:
    """Let a parser raise `GeometryError` for them: they may be large beyond measure, or
    files."""

    def refuse(value: str) -> NoReturn:
        what = f"line {parser.CurrentLineNumber}"
        raise GeometryError(what, value, "left out; entities are not read")

    def check_document_type(
        name: str, system: str | None, public: str | None, declares: bool
    ) -> None:
        if declares:
            refuse(f"<!DOCTYPE {name}> with declarations")

    def refuse_entity(name: str, is_parameter: bool) -> None:
        refuse(f"&{name};")

    parser.StartDoctypeDeclHandler = check_document_type
    parser.SkippedEntityHandler = refuse_entity
