"""XML that programs save is read within bounds, and its columns get names of their own."""

import io
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import elements
from swingdown.measurement.files.elements import Columns, distinct, number, roots, text_in


def zipped(**files):
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in files.items():
            archive.writestr(name.replace("_", "."), content)
    return io.BytesIO(made.getvalue())


def tags(source, name="run.xml"):
    return [root.tag for root in roots(source, name, "Some Program", ".xml")]


def test_a_file_has_one_root_and_an_archive_one_for_each_file_of_the_ending():
    assert tags(io.BytesIO(b"<run><cell/></run>")) == ["run"]
    assert tags(zipped(a_xml="<first/>", notes_txt="no XML", b_XML="<second/>")) == ["first", "second"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"<run>", "no XML, or not whole"),
        (b"", "no XML, or not whole"),
        (b"PK\x03\x04 and no archive", "cannot be read"),
        (b'<!DOCTYPE run [<!ENTITY a "b">]><run>&a;</run>', "declares a document type"),
        (b'<?xml version="1.0" encoding="none-such"?><run/>', "cannot be read"),
    ],
)
def test_what_is_no_plain_xml_is_refused_by_the_file_s_name(content, said):
    with pytest.raises(InputError, match=said) as refused:
        tags(io.BytesIO(content))
    assert "run.xml" in str(refused.value) and "save it again in Some Program" in str(refused.value)


def test_an_archive_without_such_a_file_says_what_it_lacks():
    with pytest.raises(InputError, match=r"holds no file that ends in \.xml"):
        tags(zipped(notes_txt="no XML"))


def test_the_largest_file_is_read_and_one_byte_more_is_not(monkeypatch):
    content = b"<run></run>"
    monkeypatch.setattr(elements, "LARGEST", len(content))
    assert tags(io.BytesIO(content)) == ["run"]
    assert tags(zipped(a_xml=content)) == ["run"]
    for larger in (io.BytesIO(content + b" "), zipped(a_xml=content + b" ")):
        with pytest.raises(InputError, match="it has more than 0 MB"):
            tags(larger)


def test_numbers_have_a_point_or_a_comma_and_other_cells_none():
    assert [number(text) for text in ("1.5", "1,5", "-2e-3", " 7 ")] == [1.5, 1.5, -0.002, 7.0]
    assert all(np.isnan(number(text)) for text in ("", None, "left", "1,2,3"))


def test_the_text_of_a_child_is_on_one_line():
    element = ElementTree.fromstring("<run><name> a\n swing </name><empty/></run>")
    assert [text_in(element, tag) for tag in ("name", "empty", "none")] == ["a swing", "", ""]


def test_names_that_repeat_are_told_apart_by_what_stands_for_them_or_a_number():
    assert distinct(["t", "x"], ["", "y"]) == ["t", "x"]
    assert distinct(["x", "x", "t"], ["left", "right", ""]) == ["x left", "x right", "t"]
    assert distinct(["x", "x", "x"], ["", "", ""]) == ["x", "x 2", "x 3"]
    assert distinct(["x", "x", "x"], ["a", "a", "a"]) == ["x a", "x a 2", "x a 3"]


def test_arrays_of_one_name_are_in_order_and_those_of_several_are_not():
    table = {"swing 1": np.zeros(2), "swing 12": np.ones(2)}
    one = Columns.of_arrays(table, "NumPy", ", .npy")
    assert one.ordered and one.layout == "arrays of NumPy, .npy" and one.about == {"source": "NumPy"}
    assert list(one.frame) == ["swing 1", "swing 12"]
    assert not Columns.of_arrays({"t": np.zeros(2), "x": np.ones(2)}, "NumPy").ordered
