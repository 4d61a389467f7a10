"""Arrays that numpy or JSON keeps are columns: those of the length that most of them have, by their names."""

import io
import json

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import saved_arrays as module
from swingdown.measurement.files.saved_arrays import saved_arrays

TIMES = np.arange(12) / 10
ANGLES = np.cos(TIMES)


def read(content, name):
    return saved_arrays(io.BytesIO(content), name)[""].frame


def numpy(save, *args, **named):
    stream = io.BytesIO()
    save(stream, *args, **named)
    return stream.getvalue()


def told(value, ending="json"):
    found = read(json.dumps(value).encode(), f"a.{ending}")
    return {name: list(found[name]) for name in found}


def test_an_array_of_two_dimensions_is_columns_whichever_way_it_lies():
    for table in (np.column_stack([TIMES, ANGLES]), np.stack([TIMES, ANGLES])):
        found = read(numpy(np.save, table), "a.npy")
        assert list(found) == ["column 1", "column 2"]
        np.testing.assert_array_equal(found["column 2"], ANGLES)


def test_arrays_have_the_names_they_were_saved_by_and_others_lengths_are_left_out():
    found = read(numpy(np.savez, t=TIMES, x=ANGLES, window=np.arange(30.0), gain=np.array(2.0)), "A.NPZ")
    assert list(found) == ["t", "x"]
    np.testing.assert_array_equal(found["x"], ANGLES)


def test_fields_of_a_record_are_columns():
    records = np.array(list(zip(TIMES, ANGLES, strict=True)), dtype=[("t", "f4"), ("x", "f8")])
    found = read(numpy(np.save, records), "a.npy")
    assert list(found) == ["t", "x"] and list(found["x"]) == list(ANGLES)


@pytest.mark.parametrize(
    "value",
    [
        {"t": list(TIMES), "x": list(ANGLES), "note": "a", "unit": ["s", "rad"] * 6, "gain": 2},
        {"run": {"data": {"t": list(TIMES), "x": list(ANGLES)}}},
        [{"t": t, "x": x, "note": "a"} for t, x in zip(TIMES, ANGLES, strict=True)],
        {"rows": [{"t": t, "x": x} for t, x in zip(TIMES, ANGLES, strict=True)]},
    ],
)  # fmt: skip
def test_lists_in_json_are_columns_wherever_they_stand(value):
    assert told(value) == {"t": list(TIMES), "x": list(ANGLES)}


def test_rows_of_json_are_columns_by_their_numbers():
    pairs = [list(one) for one in zip(TIMES, ANGLES, strict=True)]
    assert told(pairs) == {"column 1": list(TIMES), "column 2": list(ANGLES)}
    assert told({"data": pairs}) == {"data 1": list(TIMES), "data 2": list(ANGLES)}


def test_what_is_no_number_in_a_list_is_missing():
    cells = [None, "x", *ANGLES[2:]]
    found = told({"t": list(TIMES), "x": cells})
    assert np.isnan(found["x"][:2]).all() and found["x"][2:] == list(ANGLES[2:])


def test_a_document_a_line_is_left_to_the_readers_of_text():
    stream = io.BytesIO(b'{"t": 0}\n{"t": 1}\n')
    assert saved_arrays(stream, "a.json") == {} and stream.tell() == 0


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        (b'{"t": [1, 2', "a.json", "cannot be read"),
        (b"[1, 2, 3]", "a.json", "no array of 10 numbers or more"),
        (b'"text"', "a.json", "no array of 10 numbers or more"),
        (numpy(np.save, np.array([{}] * 12, dtype=object)), "a.npy", "cannot be read"),  # it would run what it holds
        (numpy(np.save, TIMES[:9]), "a.npy", "no array of 10 numbers or more"),
    ],
)  # fmt: skip
def test_what_holds_no_such_array_is_refused(content, name, words):
    with pytest.raises(InputError, match=words) as told:
        read(content, name)
    assert told.value.mend == "save its columns as a CSV file"


def test_a_file_too_large_to_be_held_is_refused_by_its_size(monkeypatch):
    content = numpy(np.save, TIMES)
    monkeypatch.setattr(module, "LARGEST", len(content))
    assert len(read(content, "a.npy")) == 12
    monkeypatch.setattr(module, "LARGEST", len(content) - 1)
    with pytest.raises(InputError, match="it has more than 0 MB"):
        read(content, "a.npy")
