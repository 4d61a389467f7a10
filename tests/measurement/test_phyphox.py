"""What phyphox writes beside its tables: the telephone, the beginning, and pauses that go on as if they had not been."""

import io
import zipfile

import pytest

from swingdown.measurement.files.phyphox import told

DEVICE = '"property","value"\n"deviceBrand","Acme"\n"deviceModel","One"\n"alone"\n'
EVENTS = [
    '"event","experiment time","system time","system time text"',
    '"START","0.0","1.6e9","2020-09-13 14:26:40.000 UTC+02:00"',
    '"PAUSE","12.346","1.6e9","2020-09-13 14:26:52.346 UTC+02:00"',
    '"START","12.346","1.6e9","2020-09-13 14:27:10.000 UTC+02:00"',
    '"PAUSE","30.5","1.6e9","2020-09-13 14:27:28.154 UTC+02:00"',
]


def archive(**files):
    """An open archive of these texts, by the names of their files in ``meta``."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as one:
        for name, text in files.items():
            one.writestr(f"meta/{name}.csv", text)
    return packed


def test_device_beginning_and_the_pause_within_are_told():
    about, pauses = told(archive(device=DEVICE, time="\n".join(EVENTS)))
    assert about == {"device": "Acme One", "begun": "2020-09-13 14:26:40.000 UTC+02:00"}
    assert pauses == ("phyphox was paused at 12.35 s and its time goes on as if it had not been",)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_whatever_stands_between_the_cells(separator):
    texts = [text.replace('","', f'"{separator}"').replace("12.346", "12,346") for text in (DEVICE, *EVENTS)]
    about, pauses = told(archive(device=texts[0], time="\n".join(texts[1:])))
    assert about["device"] == "Acme One" and "paused at 12.35 s" in pauses[0]


def test_a_recording_without_a_pause_within_says_nothing_of_it():
    about, pauses = told(archive(time="\n".join(EVENTS[:3])))
    assert pauses == () and about == {"begun": "2020-09-13 14:26:40.000 UTC+02:00"}
    assert (
        told(archive(time="\n".join([*EVENTS[:2], EVENTS[2].replace("12.346", "?"), *EVENTS[3:]])))[1] == ()
    )


@pytest.mark.parametrize(
    "given", [io.BytesIO(b"t,x\n0,1\n"), archive(other="a,b\n"), archive(device="x" * 1_000_000)]
)
def test_other_files_tell_nothing_and_are_read_from_their_beginning(given):
    given.seek(3)
    assert told(given) == ({}, ()) and given.tell() == 0
